"""A sentence of a page: what is known, how it is known, and on which theorems it rests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from certreg.results import Guarantee

THEOREMS = {  # claims of `certreg derive`, by the titles of their pages
    "optimality_certificate": "The optimality certificate",
    "pair_lengths": "Two pairs within their bounds have nearly the same length",
    "few_neighbours": "Many pairs within their bounds are many neighbours",
    "few_colours": "Neighbours with few colours",
    "weighted_refutation": "Weights that refute pairs together",
    "scaled_lengths": "Lengths, where the scale is free",
    "scaled_refutation": "Weights that refute pairs at every scale",
    "chord_bound": "A truncated square is above its chord",
    "truncated_box": "A box of rotations without a better truncated cost",
    "truncated_survey": "Boxes of quaternions and truncated squares",
    "angle_of_consensus": "The rotation of every motion within the bounds",
    "translation_gap": "What a translation costs",
    "classification": "The eight kinds of equilibrium set",
    "eigenvectors": "Equilibria are eigenvectors",
    "unstable_count": "As many growing modes as the index",
    "instability": "Every spurious equilibrium is unstable",
    "certified_basin": "The certified basin",
    "dual_bound": "A multiplier that is proved is a bound",
    "spectrum": "The spectrum of Davenport's matrix",
    "eigenvector_radius": "How far the points may move before the eigenvector has turned",
    "scale_radius": "Between which numbers the scale stays",
    "scale_elimination": "The best scale, and what it costs",
    "breathing_equilibria": "Where the body that breathes rests",
    "descartes": "How many eigenvalues are positive",
    "breathing_confined": "A body with little energy does not collapse",
    "spring_translation": "What a translation costs with matrices of springs",
    "quartic_relaxation": "A quartic, and its sums of squares",
    "bernstein_cones": "Cones and Bernstein coefficients",
    "spring_caps": "Caps: curvature at a centre",
    "growth_form": "The growth form",
    "growth_radius": "How far the points may move",
    "forty_lines": "At most forty critical lines",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Sentence:
    """What is known, how it is known, and the names of the theorems that it rests on."""

    words: str
    guarantee: Guarantee
    theorems: tuple[str, ...] = ()


def begun(words: str) -> str:
    """Words as the beginning of a sentence."""
    return words[:1].upper() + words[1:]


def sentence(words: str) -> str:
    """Words as a sentence that ends by itself."""
    ended = words.removesuffix(":").removesuffix(".")
    whole = begun(ended if ended.endswith("?") else f"{ended}.")
    return whole.replace(" %", "\u00a0%")  # on one line
