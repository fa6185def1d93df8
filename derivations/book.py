"""The book of claims: chapters, and in them the claims in an order in which each can be read."""

from __future__ import annotations

import importlib
from dataclasses import dataclass

from .kernel import Claim


@dataclass(frozen=True, slots=True)
class Chapter:
    """A title and the names of its claims, which are the names of files in `claims`."""

    title: str
    names: tuple[str, ...]


CHAPTERS = (
    Chapter(
        "The moving body",
        (
            "quaternions",
            "inertia",
            "kinetic_energy",
            "potential_energy",
            "maximum_likelihood",
            "total_force",
            "total_torque",
            "dalembert",
            "euler_poincare",
            "cayley_chart",
            "dissipation",
            "equilibrium_equations",
            "properness",
            "convergence",
        ),
    ),
    Chapter(
        "Equilibria are eigenvectors",
        (
            "davenport",
            "torque",
            "eigenvectors",
            "half_turns",
            "spectrum",
            "discriminant",
            "hessian",
            "classification",
            "morse_bott",
            "generic",
            "symmetry",
        ),
    ),
    Chapter(
        "Stability",
        (
            "ambient_jacobian",
            "intrinsic_jacobian",
            "pushforward",
            "characteristic_polynomial",
            "unstable_count",
            "instability",
            "optimal_damping",
        ),
    ),
    Chapter(
        "Integrators",
        (
            "polar_projection",
            "euler_energy",
            "midpoint",
            "splitting",
        ),
    ),
    Chapter(
        "Certificates",
        (
            "elimination",
            "optimality_certificate",
            "energy_range",
            "equilibrium_count",
            "dual_bound",
            "certified_basin",
            "covariance",
            "relaxation_tightness",
            "translation_gap",
            "eigenvector_radius",
        ),
    ),
    Chapter(
        "A free scale",
        (
            "breathing_motion",
            "scale_elimination",
            "breathing_midpoint",
            "descartes",
            "breathing_equilibria",
            "breathing_confined",
            "scale_covariance",
            "scale_radius",
        ),
    ),
    Chapter(
        "General springs",
        (
            "spring_translation",
            "growth_form",
            "quartic_relaxation",
            "growth_radius",
            "bernstein_cones",
            "spring_caps",
            "spring_motion",
            "forty_lines",
            "forty_real",
            "real_lines",
            "near_isotropy",
            "stable_spurious",
            "spring_rest",
            "spring_index",
        ),
    ),
    Chapter(
        "Wrong pairs",
        (
            "pair_lengths",
            "scaled_lengths",
            "few_neighbours",
            "few_colours",
            "weighted_refutation",
            "cliques_without_groups",
            "scaled_refutation",
            "consensus_labels",
            "angle_of_consensus",
            "chord_bound",
            "truncated_box",
            "truncated_survey",
            "arcs",
            "springs_that_break",
        ),
    ),
)


def claim(name: str) -> Claim:
    """The claim of that name. Raises KeyError where the book has none."""
    if name not in names():
        raise KeyError(name)
    module = importlib.import_module(f".claims.{name}", __package__)
    found: Claim = module.CLAIM
    return found


def names() -> tuple[str, ...]:
    """The names of all claims, in the order of the book."""
    return tuple(name for chapter in CHAPTERS for name in chapter.names)


def claims() -> tuple[Claim, ...]:
    """All claims, in the order of the book."""
    return tuple(map(claim, names()))
