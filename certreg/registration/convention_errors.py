"""The usual slips between a tool and a bad verdict: which of them makes of the pose an optimal one.

Each slip is undone exactly, and the pose that this gives is assessed as any other. So what is named
is proved: that pose is (nearly) optimal. That the slip led there is the plainest explanation, no
more, as two of them can give the same pose: the inverse is also what swapped clouds give.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.bounds import ExactPose
from certreg.exact.dyadic import nearest_root
from certreg.geometry.pose_matrix import ROTATION_TOLERANCE, why_no_rotation
from certreg.geometry.so3 import quaternion_from_matrix, rotation_matrix
from certreg.registration.findings import (
    GOOD,
    Findings,
    added,
    findings,
    nearest_quaternion,
    pose_through,
    rotated,
    turned,
    verdict_of,
)
from certreg.registration.landscape import AssessmentSettings, linear_rounding_cost, little
from certreg.results import Brief, PoseVerdict

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry.given import GivenPose
    from certreg.registration.result import Registration

UNITS = {  # of the translation against the clouds
    "1000": "millimetres against metres",
    "100": "centimetres against metres",
    "10": "millimetres against centimetres, or angstrom against nanometres",
    "25.4": "millimetres against inches",
    "0.3048": "feet against metres",
}
BEST = ", and with the best translation then,"
LEAST_DECIMALS = 2  # of the entries: with so few, as of a quarter turn, they may all be exact
FEW_DECIMALS = range(LEAST_DECIMALS + 1, 15)  # doubles have 15 digits
SETTLED = Fraction(1, 10**6)  # of the range of energies: a thousandth of the clouds' size


class SlipCode(enum.Enum):
    """A slip; the value is the word used in files."""

    INVERSE = "inverse"  # or the clouds are swapped
    TRANSPOSED = "transposed"
    QUATERNION_ORDER = "quaternion-order"
    CENTRED = "centred"
    SCALED = "scaled"
    TRANSLATION = "translation"  # of the rotation nothing is wrong


@dataclass(frozen=True, slots=True, kw_only=True)
class Slip(Brief):
    """A slip that explains a bad verdict, and what is proved of the pose without it.

    verdict: optimal or near-optimal. words: what the slip is, in a sentence.
    """

    code: SlipCode
    verdict: PoseVerdict
    words: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Mended:
    """A pose with one slip undone; subject, why: of a sentence, subject 'is optimal:' why.

    cost: of rounding the optimal pose, written as the given one is.
    """

    code: SlipCode
    pose: ExactPose
    cost: Fraction
    subject: str
    why: str


def slip_of(
    registration: Registration, given: GivenPose, settings: AssessmentSettings
) -> Slip | None:
    """The slip without which a pose is optimal, or else near-optimal; None if there is none.

    given: a pose with a bad verdict, or one whose rotation is none. Raises UndecidedError where the
    optimum could not be certified.
    """
    if why_no_rotation(given.turn, settings.rotation_tolerance) is None:
        slipped = Slipped.of(registration, given)
        tries: list[Iterator[Mended]] = [
            chain.from_iterable(undo(slipped) for undo in UNDOING[slipped.alone]),
            iter(()) if slipped.alone else _moved(slipped),
        ]
        if not slipped.alone and _lever_words(slipped):  # the plainer explanation: no slip at all
            tries.reverse()
        return _named(slipped, tries[0], settings) or _named(slipped, tries[1], settings)
    scale = _scale(given.turn)
    if scale is None:
        return None
    slipped = Slipped.of(registration, given)
    return _named(slipped, _unscaled(slipped, scale), settings)


def _named(slipped: Slipped, tries: Iterator[Mended], settings: AssessmentSettings) -> Slip | None:
    """The first pose that is optimal; else, of those that are near it, the one of the least gap."""
    near: tuple[Fraction, Slip] | None = None
    for mended in tries:
        facts = findings(slipped.registration, mended.pose, mended.cost, settings)
        verdict, gap = verdict_of(facts, settings), facts.bounds.greatest_gap
        if verdict in GOOD and _is_close(facts, settings):
            words = f"{mended.subject} is {verdict.value}: {mended.why}"
            slip = Slip(code=mended.code, verdict=verdict, words=words)
            if verdict is PoseVerdict.OPTIMAL:
                return slip
            near = (gap, slip) if near is None or gap < near[0] else near
    return None if near is None else near[1]


def _is_close(facts: Findings, settings: AssessmentSettings) -> bool:
    """Whether a pose is as near as rounding and few printed digits leave one.

    More can be chance: of a turn about an axis the quaternion is one about an axis in any order.
    """
    near = facts.away is not None and facts.away <= settings.equilibrium_angle
    return near and facts.bounds.greatest_gap <= little(settings, facts.place.energy_range)


@dataclass(frozen=True, slots=True, kw_only=True)
class Slipped:
    """What the slips are undone with.

    q: the integer quaternion of the rotation, the nearest one; cost: of rounding the optimal pose.
    x, y: the centroids. shift: the translation; image: where the pose takes x. alone: whether only
    a rotation was given, and the translation is the best one for it.
    """

    registration: Registration
    given: GivenPose
    cost: Fraction
    q: tuple[int, ...]
    x: list[Fraction]
    y: list[Fraction]
    shift: list[Fraction]
    image: list[Fraction]
    alone: bool

    @classmethod
    def of(cls, registration: Registration, given: GivenPose) -> Slipped:
        """Of a pose as it was given."""
        moments, alone = registration.solution.moments, given.translation is None
        x, y = list(moments.source_centroid), list(moments.target_centroid)
        moved = turned(given.turn, x)
        shift = [b - a for a, b in zip(moved, y, strict=True)]
        if given.translation is not None:
            shift = [Fraction(entry) for entry in given.translation.tolist()]
        return cls(
            registration=registration,
            given=given,
            cost=linear_rounding_cost(registration, _normalised(given)),
            q=nearest_quaternion(given.turn),
            x=x,
            y=y,
            shift=shift,
            image=added(moved, shift),
            alone=alone,
        )

    @property
    def off(self) -> list[Fraction]:
        """How far the image of the source's centroid is from the target's, along each axis."""
        return [a - b for a, b in zip(self.image, self.y, strict=True)]

    @property
    def is_settled(self) -> bool:
        """Whether the translation is the best one for the rotation, as it was given."""
        objective = self.registration.solution.objective
        pose = pose_through(self.q, self.x, self.image)
        energy = objective.translation_energy(self.q, pose.translation)
        return energy**2 <= SETTLED**2 * objective.least_range_squared

    def mended(self, code: SlipCode, pose: ExactPose, subject: str, why: str) -> Mended:
        """A pose that is written as the optimal one."""
        return Mended(code=code, pose=pose, cost=self.cost, subject=subject, why=why)

    def written(self, pose: ExactPose) -> list[tuple[str, ExactPose]]:
        """A pose, and its rotation with the best translation, where the given one is the best."""
        best = self.at_best(pose.quaternion)
        if self.alone:
            return [("", best)]
        return [("", pose), *([(BEST, best)] if self.is_settled else [])]

    def at_best(self, q: Sequence[int]) -> ExactPose:
        """A rotation with its best translation: it takes one centroid to the other."""
        return pose_through(q, self.x, self.y)


def _inverse(slipped: Slipped) -> Iterator[Mended]:
    """The pose x = R^T (y - t)."""
    back = _conjugate(slipped.q)
    why = "does it take the target to the source, or are the clouds swapped?"
    start = added(turned(slipped.given.turn, slipped.y), slipped.shift)
    pose = slipped.at_best(back) if slipped.alone else pose_through(back, start, slipped.y)
    cost = linear_rounding_cost(slipped.registration, slipped.given, inverse=True)
    yield Mended(code=SlipCode.INVERSE, pose=pose, cost=cost, subject="Its inverse", why=why)


def _transposed(slipped: Slipped) -> Iterator[Mended]:
    back, turn = _conjugate(slipped.q), slipped.given.turn
    moved = turned(turn.T, slipped.x) if slipped.given.is_matrix else rotated(back, slipped.x)
    transposed = pose_through(back, slipped.x, added(moved, slipped.shift))
    for more, pose in slipped.written(transposed):
        yield slipped.mended(
            SlipCode.TRANSPOSED,
            pose,
            f"The pose with its rotation transposed{more}",
            "is its matrix written by columns, or for row vectors?",
        )


def _reordered(slipped: Slipped) -> Iterator[Mended]:
    a, b, c, d = slipped.q
    orders = (
        ((d, a, b, c), "x y z w", "was it written with the scalar last, and read as w x y z?"),
        ((b, c, d, a), "w x y z", "was it written with the scalar first, and read as x y z w?"),
    )
    for q, order, why in orders:
        reordered = ExactPose(quaternion=q, translation=tuple(slipped.shift))
        for more, pose in slipped.written(reordered):
            subject = f"The pose with its quaternion read as {order}{more}"
            yield slipped.mended(SlipCode.QUATERNION_ORDER, pose, subject, why)


def _centred(slipped: Slipped) -> Iterator[Mended]:
    images = (
        (added(slipped.shift, slipped.y), "both centroids", "clouds moved to their centroids"),
        (slipped.shift, "the source's centroid", "a source moved to its centroid"),
        (
            added(slipped.image, slipped.y),
            "the target's centroid",
            "a target moved to its centroid",
        ),
    )
    for image, what, where in images:
        yield slipped.mended(
            SlipCode.CENTRED,
            pose_through(slipped.q, slipped.x, image),
            f"The pose with {what} put back",
            f"is its translation for {where}?",
        )


def _in_other_units(slipped: Slipped) -> Iterator[Mended]:
    if not any(slipped.shift):
        return
    start = [a - b for a, b in zip(slipped.image, slipped.shift, strict=True)]
    for number, units in UNITS.items():
        unit = Fraction(number)
        for factor, times in ((unit, "times"), (1 / unit, "divided by")):
            image = added(start, [factor * entry for entry in slipped.shift])
            yield slipped.mended(
                SlipCode.SCALED,
                pose_through(slipped.q, slipped.x, image),
                f"The pose with its translation {times} {number}",
                f"{units}?",
            )


def _unscaled(slipped: Slipped, scale: float) -> Iterator[Mended]:
    """The rotation in a multiple of one: with the scale and the translation of a similarity."""
    subject, why = f"Its rotation without the scale {scale:.6g}", "a pose has none."
    if abs(scale - 1.0) <= ROTATION_TOLERANCE:
        subject, why = "The rotation nearest to it", "digits may be missing."
    images = [slipped.y]
    if not slipped.alone:
        start = rotated(slipped.q, slipped.x)
        divided = [entry / Fraction(scale) for entry in slipped.shift]
        images = [slipped.image, added(start, slipped.shift), added(start, divided)]
    for image in images:
        yield slipped.mended(
            SlipCode.SCALED,
            pose_through(slipped.q, slipped.x, image),
            subject,
            why,
        )


def _moved(slipped: Slipped) -> Iterator[Mended]:
    objective = slipped.registration.solution.objective
    degrees = math.degrees(objective.angle_to_optimum(slipped.q))
    shift = nearest_root(sum((entry * entry for entry in slipped.off), start=Fraction(0)))
    far = "" if shift is None else f", its translation {shift:.3g} from the best one for it"
    which = "the optimal one" if objective.classification.unique else "the nearest optimal one"
    yield slipped.mended(
        SlipCode.TRANSLATION,
        slipped.at_best(slipped.q),
        "The pose with the best translation for its rotation",
        f"its rotation is {degrees:.2g} degrees from {which}{far}{_lever_words(slipped)}.",
    )


def _lever_words(slipped: Slipped) -> str:
    """That the few digits of a matrix can move the cloud as far, where it is far from the origin.

    With d decimals every entry of the rotation is at most half a unit of the last off, and a
    coordinate of the image of x at most that times |x1| + |x2| + |x3|.
    """
    if not slipped.given.is_matrix:
        return ""
    turn = slipped.given.turn
    decimals = next((d for d in FEW_DECIMALS if np.array_equal(turn.round(d), turn)), None)
    if decimals is None or np.array_equal(turn.round(LEAST_DECIMALS), turn):
        return ""
    lever = sum(map(abs, slipped.x), start=Fraction(0))
    if max(map(abs, slipped.off)) > Fraction(1, 2 * 10**decimals) * lever:
        return ""
    return (
        f"; writing its entries with {decimals} decimals can cost as much, so far from the origin"
    )


UNDOING = {  # by whether a rotation alone was given: its transpose is the inverse
    False: (_inverse, _transposed, _reordered, _centred, _in_other_units),
    True: (_inverse, _reordered),
}


def _conjugate(q: Sequence[int]) -> tuple[int, ...]:
    w, *axial = q
    return (w, *(-entry for entry in axial))


def _scale(turn: NDArray[np.float64]) -> float | None:
    """What a multiple of a rotation is multiplied by; None of what is none."""
    if turn.shape == (4,):
        norm = math.hypot(*turn.tolist())
        return norm if 0.0 < norm < np.inf else None
    scale = float(np.linalg.svd(turn, compute_uv=False).mean())
    if not 0.0 < scale < np.inf or why_no_rotation(turn / scale, ROTATION_TOLERANCE):
        return None
    return scale


def _normalised(given: GivenPose) -> GivenPose:
    """The pose as it would be written without its scale."""
    if not given.is_matrix:
        return replace(given, turn=given.turn / math.hypot(*given.turn.tolist()))
    q = quaternion_from_matrix(given.turn)
    return replace(given, turn=np.array(rotation_matrix(q.tolist())))
