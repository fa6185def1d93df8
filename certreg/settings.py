"""Every number that is a choice, with its reason. Nothing here can weaken a proof."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class AgreementSettings:
    """When a floating-point road contradicts the certificate.

    Losses are relative to the alignment between the best and the worst rotation.
    """

    closed_form_loss: float = 1e-11  # a thousand times the rounding of an O(N) sum
    relaxation_loss: float = 1e-5  # a thousand times the solver's tolerance
    simulation_loss: float = 1e-2  # a run stops at |s'| < 1e-4, near the optimum, not at it
    energy_ulps: float = 64.0  # of rounding in a logged energy: a sum of twelve products


@dataclass(frozen=True, slots=True, kw_only=True)
class RelaxationSettings:
    """How far the semidefinite solver goes. Data are scaled so that the largest entry is near 1."""

    gap_tolerance: float = 1e-8  # Clarabel's own default
    feasibility_tolerance: float = 1e-8  # as above
    max_iterations: int = 100  # seven are usual
    rank_threshold: float = 1e-4  # of the largest eigenvalue of Z


@dataclass(frozen=True, slots=True, kw_only=True)
class CoqSettings:
    """How long Coq may think, and how a certificate is cut up for it."""

    seconds: float = 600.0  # 338 points take four; hostile exponents could take days
    points_in_a_list: int = 500  # 10^5 overflow the stack of its parser
