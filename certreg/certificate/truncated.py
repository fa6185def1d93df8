"""Certificates of kind "truncated-rotation": a rotation of least truncated squares, and labels.

The checker searches all rotations again, in boxes, so a rotation and labels are nearly all there
is; the theorems are in `certreg.verify`. What is made of a search has room for proofs: the search
is in doubles; the checker, in integers, tries all anew. What it rounds away is 6 N 2^-64 of the
cost, and the rotation is off by the rounding of an eigenvector, about 2^-52 |M| / d, M the form of
the pairs within their bounds, d = l2 - l1. One 4x4 matrix says whether a set of pairs may be those
within their bounds at an optimum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from certreg.certificate.checking import CertificateVerdict, as_verdict
from certreg.certificate.envelope import Certificate, enclosed
from certreg.certificate.pose_claims import PoseBody, PoseClaims
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below
from certreg.geometry.so3 import davenport_matrix
from certreg.verify import (
    PRODUCTS,
    UNITS,
    bounded_pairs,
    check,
    form_at,
    form_of,
    positive_definite,
    twice,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.problem import RegistrationProblem


@dataclass(frozen=True, slots=True, kw_only=True)
class TruncatedClaims(PoseClaims):
    """What the certificate claims besides; the checker proves each from the data or refuses.

    labels: a character a pair: 1, at every optimum it is within its bound; 0, at every optimum it
        is not; ?, no claim.
    unique: True claims that the optimum is one single rotation; False claims nothing.
    """

    labels: str
    unique: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class TruncatedRotationBody(PoseBody):
    """A proof that a rotation is optimal; mu makes that of the angle short."""

    KIND: ClassVar[str] = "truncated-rotation"
    PLACES: ClassVar = {"quaternion": "pose", "mu": "optimality.mu"}

    mu: Dyadic
    claims: TruncatedClaims


BOUND_BITS = 32  # mantissas of what is claimed: short numbers
POSE_BITS = 60  # of the entries of the quaternion
ROUNDING = 2.0**-64  # of the checker, of each pair's cost, six times
LEAST_GAP = 2.0**-34  # of each pair's cost: room for the rounding of the search, too
LEAST_SINE = 2.0**-54  # squared, of half the angle: 1.5e-8 radians
EIGENVECTOR = 2.0**-49  # of |M| / d: eight times its rounding
LABELS = {1: "1", 0: "0", -1: "?"}
GROWTH = 2.0**10  # of the gap that is claimed, after a refusal
ATTEMPTS = 5


def truncated_certificate(
    problem: RegistrationProblem,
    quaternion: NDArray[np.float64],
    labels: NDArray[np.int64],
    gap: float,
    *,
    about: dict[str, Any] | None = None,
) -> tuple[Certificate[TruncatedRotationBody] | None, CertificateVerdict]:
    """A certificate that the checker accepts, of a rotation (4,), labels (N,) and a gap; its word.

    labels: 1 within, 0 beyond its bound at every optimum, -1 open. gap: what the cost exceeds the
    minimum by. Where the angle is not proved it is left out; where the gap is not, a larger one is
    tried. None with the reason of the last refusal: not proved, not disproved.
    """
    word = "".join(LABELS[label] for label in labels.tolist())
    mu, sine = _angle(problem, labels) if "?" not in word else (0.0, 1.0)
    proved = sine < 1.0
    claims = TruncatedClaims(
        gap=_dyadic(max(1.01 * gap, LEAST_GAP * problem.n)),
        labels=word,
        sin2_half_angle=_dyadic(sine) if proved else None,
        unique=proved,
    )
    w, x, y, z = (round(entry * 2.0**POSE_BITS) for entry in quaternion.tolist())
    body = TruncatedRotationBody(
        quaternion=(w, x, y, z), mu=dyadic_below(Fraction(mu), BOUND_BITS), claims=claims
    )
    return _accepted(enclosed(problem, body, about), ATTEMPTS)


def _accepted(
    certificate: Certificate[TruncatedRotationBody], attempts: int
) -> tuple[Certificate[TruncatedRotationBody] | None, CertificateVerdict]:
    """The certificate, or one that claims less, where the checker accepts it."""
    verdict, claims = as_verdict(check(certificate.line())), certificate.body.claims
    if verdict.proved:
        return certificate, verdict
    if attempts == 1:
        return None, verdict
    if "angle" in verdict.words or "unique" in verdict.words:
        weaker = replace(claims, sin2_half_angle=None, unique=False)
    else:
        weaker = replace(claims, gap=_dyadic(GROWTH * float(claims.gap.value)))
    body = replace(certificate.body, claims=weaker)
    return _accepted(replace(certificate, body=body), attempts - 1)


def _dyadic(value: float) -> Dyadic:
    return dyadic_above(Fraction(value), BOUND_BITS)


def _angle(problem: RegistrationProblem, labels: NDArray[np.int64]) -> tuple[float, float]:
    """Half of l2 - l1 of the pairs within their bounds, and sin^2 of half the angle; 1: no claim.

    With mu = d / 2 a residual e of the rotation needs delta above 4 |M|^2 e^2 / d, or so.
    """
    rows = labels == 1
    bounds = problem.bounds[rows, np.newaxis]
    x, y = problem.source[rows] / bounds, problem.target[rows] / bounds
    K = np.array(davenport_matrix((y.T @ x).tolist()))
    values = np.linalg.eigvalsh((x * x + y * y).sum() * np.eye(4) - 2.0 * K)
    room = float(values[1] - values[0])
    if not room > 0.0:
        return 0.0, 1.0
    size = EIGENVECTOR * float(values[-1]) / room
    rounding = 24.0 * problem.n * ROUNDING / room
    return room / 2.0, max(LEAST_SINE, 16.0 * size * size, rounding)


def disproves_labels(
    problem: RegistrationProblem, within: Sequence[bool], quaternion: Sequence[int]
) -> bool:
    """Whether no optimum has just these pairs within their bounds, proved in integers.

    within: of each pair. quaternion: of a good rotation, any length. Where just these are within,
    the cost is the number of the others plus a form in p, |p| = 1: if that is above the cost of the
    good rotation for all p, no such rotation is optimal. False means not disproved, not proved.
    """
    rows, _ = bounded_pairs(problem.data_bytes()[-64 * problem.n :], problem.n)
    forms, one = [form_of(row)[0] for row in rows], 1 << UNITS
    norm = sum(c * c for c in quaternion)
    cost = sum(min(-(-form_at(k, quaternion) // norm) + 6, one) for k in forms)
    spare = cost - one * sum(not inside for inside in within)
    chosen = [form for form, inside in zip(forms, within, strict=True) if inside]
    sums = [sum(part) for part in zip(*chosen, strict=True)] or [0] * len(PRODUCTS)
    lifted = [k - spare * (i == j) for k, (i, j) in zip(sums, PRODUCTS, strict=True)]
    return positive_definite(twice(lifted))
