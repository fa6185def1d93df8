"""The proof panel: what is known, in sentences, each with how it is known and by which theorem."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.exact import double_above
from certreg.report.summary import bounded, count_words, margin_words, proved_degrees
from certreg.results import ComponentKind, Guarantee
from certreg.settings import ReportSettings

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.registration import Agreement, Registration
    from certreg.verify import Isotropic

THEOREMS = {  # claims of `certreg derive`, by the titles of their pages
    "optimality_certificate": "The optimality certificate",
    "translation_gap": "What a translation costs",
    "classification": "The eight kinds of equilibrium set",
    "eigenvectors": "Equilibria are eigenvectors",
    "unstable_count": "As many growing modes as the index",
    "instability": "Every spurious equilibrium is unstable",
    "certified_basin": "The certified basin",
    "dual_bound": "A multiplier that is proved is a bound",
    "spectrum": "The spectrum of Davenport's matrix",
}
NOT_CLAIMED = (
    "that the correspondences are right: a wrong pair is registered as faithfully as a right one;",
    "that the noise is Gaussian, or the bodies rigid;",
    "that the optimum is close to the truth: only that no pose fits these numbers better;",
    "where the points come from, nor what the certificate says under `about`: names and labels.",
)
WEAK = "PROVED IN PART: the certificate in this file proves less than can be proved."
NAMES = {
    ComponentKind.POINT: "one pose",
    ComponentKind.CIRCLE: "a circle of poses",
    ComponentKind.PROJECTIVE_PLANE: "a projective plane of poses",
    ComponentKind.ROTATION_GROUP: "every rotation",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Sentence:
    """What is known, how it is known, and the names of the theorems that it rests on."""

    words: str
    guarantee: Guarantee
    theorems: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Roads:
    """How far independent roads ended from the pose, in degrees; None where not taken."""

    closed_form: float
    relaxation: float | None
    simulation: float | None

    @classmethod
    def of(cls, agreement: Agreement) -> Roads:
        """From the angles in radians."""
        others = (agreement.relaxation, agreement.simulation)
        relaxation, simulation = (None if a is None else math.degrees(a) for a in others)
        return cls(
            closed_form=math.degrees(agreement.closed_form),
            relaxation=relaxation,
            simulation=simulation,
        )


def sentences(registration: Registration, stated: Isotropic, roads: Roads) -> list[Sentence]:
    """What the page says is known; `stated` by a certificate that was accepted."""
    return [
        *_optimality(registration),
        *_equilibria(registration, stated),
        *_motion(stated),
        *_numbers(registration, roads),
    ]


def weak_words(registration: Registration) -> str:
    """What a certificate proves that proves less than could be proved."""
    bounds, degrees = registration.bounds, proved_degrees(registration)
    gap = "an amount beyond doubles" if bounds is None else bounded(bounds.gap_upper)
    angle = "of its angle to the best one, it proves nothing"
    if degrees is not None:
        angle = f"its rotation is within {degrees} degrees of the best one"
    return (
        f"Of the pose printed here it proves this: its objective exceeds the minimum by at most "
        f"{gap}, and {angle}. The certificate that certreg certify writes for these points proves "
        "more."
    )


def _optimality(registration: Registration) -> Iterator[Sentence]:
    bounds = registration.bounds
    if bounds is None:
        return
    yield Sentence(
        words=(
            "Over all rotations and translations: the sum of weighted squared "
            f"distances at the pose printed here exceeds the minimum by at most "
            f"{bounded(bounds.gap_upper)}."
        ),
        guarantee=Guarantee.EXACT,
        theorems=("optimality_certificate", "translation_gap"),
    )
    degrees = proved_degrees(registration)
    if degrees is not None:
        yield Sentence(
            words=(
                "The best rotation is unique, and the one printed here is within "
                f"{degrees} degrees of it."
            ),
            guarantee=Guarantee.EXACT,
            theorems=("optimality_certificate", "classification"),
        )
        return
    if registration.equilibria.classification.unique:
        yield Sentence(
            words="The best rotation is unique. How far it is from the one printed is not bounded.",
            guarantee=Guarantee.EXACT,
            theorems=("classification",),
        )
        return
    kind = NAMES[registration.equilibria.components[0].kind]
    yield Sentence(
        words=f"The best rotation is not unique: the optima are {kind}, all exactly as good.",
        guarantee=Guarantee.EXACT,
        theorems=("classification",),
    )


def _equilibria(registration: Registration, stated: Isotropic) -> Iterator[Sentence]:
    equilibria = registration.equilibria
    counted = count_words(equilibria).split(": ", 1)[1]
    listed = ", ".join(f"{NAMES[c.kind]} of index {c.morse_index}" for c in equilibria.components)
    yield Sentence(
        words=f"There are {counted[:-1]}: {listed}. The list is complete.",
        guarantee=equilibria.guarantee,
        theorems=("eigenvectors", "classification"),
    )
    unstable = equilibria.classification.unstable
    if unstable is None:
        yield Sentence(
            words=(
                "The source points are on one line, so the dynamics of the body is not defined. "
                "The energy falls in as many directions as the index says."
            ),
            guarantee=equilibria.guarantee,
            theorems=("classification",),
        )
    elif len(unstable) > 1 and stated.unstable is not None:
        counts = ", ".join(map(str, unstable))
        yield Sentence(
            words=(
                f"In this order they have {counts} growing modes: whatever is not optimal is "
                "unstable, and the smallest push makes a body leave it."
            ),
            guarantee=equilibria.guarantee,
            theorems=("unstable_count", "instability"),
        )


def _motion(stated: Isotropic) -> Iterator[Sentence]:
    if stated.basin:
        yield Sentence(
            words=(
                "The simulated body ended in a state from which the exact motion can end nowhere "
                "but at the optimum."
            ),
            guarantee=Guarantee.EXACT,
            theorems=("certified_basin",),
        )
    gap = stated.sdp_gap
    if gap is not None:
        yield Sentence(
            words=(
                "The dual of the semidefinite relaxation, rounded outwards, bounds the gap "
                f"independently: at most {bounded(double_above(gap))}."
            ),
            guarantee=Guarantee.EXACT,
            theorems=("dual_bound",),
        )


def _numbers(registration: Registration, roads: Roads) -> Iterator[Sentence]:
    yield Sentence(
        words=(
            "Poses, energies and RMSE are rounded to doubles from at least 57 digits. The "
            "eigenvalues in the chart are computed in double precision; the signs of their real "
            "parts are exact."
        ),
        guarantee=Guarantee.NUMERICAL,
        theorems=("spectrum",),
    )
    yield Sentence(words=_roads_words(roads), guarantee=Guarantee.NUMERICAL)
    yield Sentence(
        words=f"The ambiguity margin is {margin_words(registration.equilibria)}.",
        guarantee=Guarantee.NUMERICAL,
        theorems=("classification",),
    )


def _roads_words(roads: Roads) -> str:
    """Which roads lead to the rotation that is printed, and which do not."""
    angles = {
        "the closed form": roads.closed_form,
        "the semidefinite relaxation": roads.relaxation,
        "the simulation": roads.simulation,
    }
    taken = {name: angle for name, angle in angles.items() if angle is not None}
    apart = [name for name, angle in taken.items() if not angle <= ReportSettings().same_rotation]
    told = [f"{name} to {angle:.1g}°" for name, angle in taken.items() if name not in apart]
    words = [f"Independent roads lead to the same rotation: {', '.join(told)}."] if told else []
    words += [
        f"{name[0].upper()}{name[1:]} does not: it ended {taken[name]:.3g}° from it. "
        "No proof rests on it."
        for name in apart
    ]
    return " ".join(words)
