"""Producing a certificate of kind "springs-list": boxes of all 40 critical lines.

The ends of the 40 paths are right to some digits of a double. In a chart q = a p, p_0 = 1, where no
line is far out, they are made right to `bits` binary places by Newton's method, residuals in
integers, Jacobians in doubles. A line is real if its imaginary parts vanish to these places; the
others come in pairs, of which the file holds one.

The checker's box of a line is one unit of the last place to either side. It accepts it if, with J
the Jacobian of the three minors E of (p, G'(p)) there, Y = J^-1 and s = max |p_i|,

    |Y E| + 12 s^2 S sum |Y| < 1,  S the sum of the coefficients of E without signs,

in units of that place, so that bits must exceed the logarithm of 12 s^2 S sum |Y| by a little, and
for the index that of 420 s^4 S over the least eigenvalue of the Hessian. Multiple lines need
infinitely many: they are never listed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from certreg.certificate.envelope import Certificate, enclosed
from certreg.certificate.pose_claims import PoseBody, PoseClaims
from certreg.certificate.squares import INLINE_SPRINGS, require_near
from certreg.equilibrium.paths import CriticalLines, PathsOutcome
from certreg.equilibrium.quartics import FloatingQuartic
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below
from certreg.geometry.so3 import body_frame, dot, squared_norm
from certreg.objective.normalisation import LevelledExactly, levelled_exactly
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.exact.spaces import IntegerQuaternion
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem

Complexes = NDArray[np.complex128]

LINES = 40
LARGEST_ENTRY, CHARTS = 9, 400  # of a chart; that are tried: in one of them no line is far out
SEED = 20262  # any
LEAST_BITS, MOST_BITS, STEP_BITS = 64, 256, 16  # the checker allows no more
ROOM_BITS = 5  # boxes are accepted with 32 times the room that is needed
GUARD_BITS = 32  # of coefficients, beyond twice the places
MODULUS = 2**31 - 1
STEPS = 12  # of Newton's method: each adds at least ten digits where the Jacobian is known
DONE = 0.75  # of a unit of the last place: both parts are rounded by half of one
SINGULAR = 1e12  # condition of a Jacobian: beyond, doubles do not know the way
GAP_BITS, SECOND_BITS = 32, 96  # of what is claimed; the barrier may be a small part of `second`

FOUND_WORDS = "All 40 critical lines are apart, simple, and in boxes of their own."
MULTIPLE_WORDS = "{} of the 40 critical lines could not be separated: they meet, or nearly so."
UNPAIRED_WORDS = "The critical lines that are not real do not come in pairs: some were found twice."


def quaternion_product(a: Sequence[int], p: Sequence[int]) -> IntegerQuaternion:
    """The product a p."""
    (w, x, y, z), (d, e, f, g) = a, p
    return (
        w * d - x * e - y * f - z * g,
        x * d + w * e - z * f + y * g,
        y * d + z * e + w * f - x * g,
        z * d - y * e + x * f + w * g,
    )


def with_positive_first(q: IntegerQuaternion) -> IntegerQuaternion:
    """The quaternion of the same rotation whose first entry that is not zero is positive."""
    w, x, y, z = q
    return q if next(filter(None, q), 1) > 0 else (-w, -x, -y, -z)


@dataclass(frozen=True, slots=True, kw_only=True)
class ListClaims(PoseClaims):
    """What a list of equilibria claims besides.

    indices: of all real equilibria, in the order of the list: how many independent directions lead
        down. Those of index 0 are stable. None is degenerate.
    second: the objective is at least that at every equilibrium but the first.
    """

    indices: Annotated[tuple[int, ...], range(41)]
    second: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsListBody(PoseBody):
    """A proof that these are all equilibria of general springs: boxes of 40 complex lines.

    quaternion: of the first equilibrium, the best.
    chart: an integer quaternion a; a critical line holds a p, p = (2^bits, x, y, z), where
        x, y, z are within 1 of the integers in `lines`.
    lines: x, x', y, y', z, z' of each, of x + i x', y + i y', z + i z': those of the equilibria,
        which are real, and one of two that are conjugate.
    modulus: with which linear algebra shows that there are no more.
    rotation_only: of a problem without a translation.
    """

    KIND: ClassVar[str] = "springs-list"
    INLINE: ClassVar[int] = INLINE_SPRINGS
    PLACES: ClassVar = {
        "quaternion": "proof.pose",
        "bits": "proof.bits",
        "chart": "proof.chart",
        "lines": "proof.lines",
        "modulus": "proof.modulus",
        "rotation_only": "rotation_only?",
    }

    bits: int
    chart: tuple[int, int, int, int]
    lines: Annotated[tuple[int, ...], range(120, 241, 6)]  # 40, half of them at least real
    modulus: int
    claims: ListClaims
    rotation_only: bool = False

    @property
    def quaternions(self) -> tuple[IntegerQuaternion, ...]:
        """Of all equilibria, right to about 2^-bits: integers (w, x, y, z) of any length."""
        rows = [self.lines[k : k + 6] for k in range(0, len(self.lines), 6)]
        real = [row[::2] for row in rows if not any(row[1::2])]
        found = [quaternion_product(self.chart, (1 << self.bits, *line)) for line in real]
        return tuple(map(with_positive_first, found))

    @property
    def stable(self) -> int:
        """How many equilibria are stable."""
        return self.claims.indices.count(0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ListProposal(Brief):
    """What is proposed to be proved of all equilibria. body: None where that is nothing."""

    body: SpringsListBody | None
    words: str


@dataclass(frozen=True, eq=False)
class Gaussian:
    """Arrays of complex integers of any size, as `LevelledExactly.gradient` takes for numbers."""

    re: Any
    im: Any

    def __add__(self, other: Gaussian) -> Gaussian:
        """The sum."""
        return Gaussian(self.re + other.re, self.im + other.im)

    def __radd__(self, zero: int) -> Gaussian:
        """Where `sum` begins."""
        return self

    def __sub__(self, other: Gaussian) -> Gaussian:
        """The difference."""
        return Gaussian(self.re - other.re, self.im - other.im)

    def __mul__(self, other: Gaussian | int) -> Gaussian:
        """The product."""
        if isinstance(other, int):
            return Gaussian(self.re * other, self.im * other)
        return Gaussian(
            self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re
        )

    __rmul__ = __mul__


def springs_list_certificate(
    problem: RegistrationProblem,
    objective: Springs,
    lines: CriticalLines,
    *,
    about: dict[str, Any] | None = None,
) -> Certificate[SpringsListBody] | None:
    """A certificate of all equilibria, from the ends of all 40 paths.

    None means not proved, not disproved: lines are multiple, or nearly so; `list_body` says it.
    """
    require_near(problem)
    body = list_body(objective, lines).body
    return None if body is None else enclosed(problem, body, about)


def list_body(objective: Springs, lines: CriticalLines) -> ListProposal:
    """A body that proves the ends of the 40 paths to be all equilibria, or why there is none.

    lines: `critical_lines(objective.floating_quartic()[0])`, of which every end is needed.
    """
    if lines.outcome is not PathsOutcome.FOUND:
        return ListProposal(body=None, words=lines.outcome.value)
    charted = ChartedQuartic.of(objective, lines.points)
    p = charted.inside(lines.points)
    needed = charted.needed_bits(p)
    within = needed <= MOST_BITS
    bits = LEAST_BITS + max(0, -(-(needed.max() - LEAST_BITS) // STEP_BITS)) * STEP_BITS
    if not within.all():
        return ListProposal(body=None, words=MULTIPLE_WORDS.format(int((~within).sum())))
    centres, steps = charted.refined(p, int(bits))
    lost = int((~(steps <= DONE)).sum())
    if lost:
        return ListProposal(body=None, words=MULTIPLE_WORDS.format(lost))
    real, pairs = _sorted_out(centres)
    if len(real) + 2 * len(pairs) != LINES:
        return ListProposal(body=None, words=UNPAIRED_WORDS)
    body = _claimed(objective, charted, int(bits), real, pairs)
    return ListProposal(body=body, words=FOUND_WORDS)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChartedQuartic:
    """The levelled quartic in the chart q = a p, p = (1, x, y, z). left: the matrix of a."""

    quartic: LevelledExactly
    chart: IntegerQuaternion
    left: NDArray[np.float64]

    @classmethod
    def of(cls, objective: Springs, points: Complexes) -> ChartedQuartic:
        """In the chart in which the farthest line is nearest."""
        charts = _charts()
        lengths = np.sqrt((charts**2).sum(axis=1))
        nearness = np.abs(charts @ points.T).min(axis=1) / lengths
        w, x, y, z = (int(entry) for entry in charts[np.argmax(nearness)])
        chart = (w, x, y, z)
        left = np.column_stack([np.array(chart, dtype=float), np.array(body_frame(chart))])
        return cls(quartic=levelled_exactly(objective.quartic), chart=chart, left=left)

    def inside(self, q: Complexes) -> Complexes:
        """The points (m, 4) of lines with p_0 = 1."""
        p = q @ self.left  # the transpose is the inverse, but for a factor
        return p / p[:, :1]

    def jacobians(self, p: Complexes) -> Complexes:
        """(m, 3, 3): of p_0 G_i - p_i G_0 by x, y, z."""
        form = FloatingQuartic.of(self.quartic.rest)
        hessians = self.left.T @ form.hessians(p @ self.left.T) @ self.left
        gradients = (hessians @ p[..., None])[..., 0] / 3.0
        found = hessians[:, 1:, 1:] - p[:, 1:, None] * hessians[:, :1, 1:]
        found[:, range(3), range(3)] -= gradients[:, :1]
        return found

    def needed_bits(self, p: Complexes) -> NDArray[np.float64]:
        """How many binary places the checker needs at each line; infinite where none are enough."""
        jacobians = self.jacobians(p)
        sizes = np.abs(p).max(axis=1)
        # Each monomial goes into a minor at most four times from either derivative.
        most = 8.0 * np.abs(self.quartic.rest).sum() * np.abs(self.chart).sum() ** 4
        condition: Any = np.linalg.cond(jacobians)
        usable = condition < SINGULAR
        jacobians[~usable] = np.eye(3)
        inverses = np.abs(np.linalg.inv(jacobians)).sum(axis=2).max(axis=1)
        norms, v = (np.abs(p) ** 2).sum(axis=1), p[:, 1:]
        hessians = norms[:, None, None] * jacobians - v[..., None] * (v[:, None, :] @ jacobians)
        linear: Any = np.linalg  # whose stubs know no stacks of matrices
        least = np.abs(linear.eigvals(hessians)).min(axis=1)
        needed: Any = np.maximum(17.0 * sizes**2 * most * inverses, 420.0 * sizes**4 * most / least)
        apart = np.abs(p[:, None] - p[None]).max(axis=2)
        np.fill_diagonal(apart, 1.0)
        needed = np.maximum(needed, 4.0 / np.maximum(apart.min(axis=1), np.finfo(float).tiny))
        return np.where(usable, np.log2(needed) + ROOM_BITS, np.inf)

    def refined(self, p: Complexes, bits: int) -> tuple[list[Gaussian], NDArray[np.float64]]:
        """Coordinates x, y, z over 2^bits, and how far the last steps went, in such units."""
        places = range(1, 4)
        inverses = np.linalg.inv(self.jacobians(p))
        x = [_rounded(p[:, k], bits) for k in places]
        quartic = self.quartic.shortened(2 * bits + GUARD_BITS)
        lengths = np.full(len(p), np.inf)
        for _ in range(STEPS):
            steps = (inverses @ self._residuals(quartic, x, bits)[..., None])[..., 0]
            last = np.abs(np.ldexp(1.0, bits) * steps).max(axis=1)
            if (last <= DONE).all():
                return x, last
            if not (last < lengths).all():
                break
            x = [entry - _rounded(step, bits) for entry, step in zip(x, steps.T, strict=True)]
            lengths = last
        return x, lengths

    def _residuals(self, quartic: LevelledExactly, x: list[Gaussian], bits: int) -> Complexes:
        """(m, 3): the minors, in the units of `jacobians`."""
        p: Any = [Gaussian(x[0].re * 0 + (1 << bits), x[0].im * 0), *x]
        rows = [
            (entry, *row) for entry, row in zip(self.chart, body_frame(self.chart), strict=True)
        ]
        q: Any = [dot(row, p) for row in rows]
        along = quartic.gradient(q)
        g: Any = [dot(column, along) for column in zip(*rows, strict=True)]
        over = 1 << (4 * bits + quartic.bits)
        minors = [p[0] * g[k] - p[k] * g[0] for k in (1, 2, 3)]
        columns = [
            [complex(a / over, b / over) for a, b in zip(minor.re, minor.im, strict=True)]
            for minor in minors
        ]
        return np.array(columns).T


@cache
def _charts() -> NDArray[np.int64]:
    """Small integer quaternions; where lines have small entries, too, few of these are far away."""
    drawn = np.random.default_rng(SEED).integers(-LARGEST_ENTRY, LARGEST_ENTRY + 1, (CHARTS, 4))
    return drawn[drawn.any(axis=1)]


def _rounded(values: Complexes, bits: int) -> Gaussian:
    """Over 2^bits."""
    re, im = (
        np.array([round(math.ldexp(float(k), bits)) for k in part], dtype=object)
        for part in (values.real, values.imag)
    )
    return Gaussian(re, im)


def _sorted_out(x: list[Gaussian]) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """The real lines, and of each pair the one whose first imaginary part is positive."""
    real: list[tuple[int, ...]] = []
    pairs: list[tuple[int, ...]] = []
    for k in range(LINES):
        imaginary: list[int] = [entry.im[k] for entry in x]
        if max(map(abs, imaginary)) <= 1:
            real.append(tuple(entry.re[k] for entry in x))
        elif next(part for part in imaginary if abs(part) > 1) > 0:
            pairs.append(tuple(part for entry in x for part in (entry.re[k], entry.im[k])))
    return real, pairs


def _claimed(
    objective: Springs,
    charted: ChartedQuartic,
    bits: int,
    real: list[tuple[int, ...]],
    pairs: list[tuple[int, ...]],
) -> SpringsListBody:
    """With all claims that follow, by the rules of the checker; the best equilibrium first."""
    found = [quaternion_product(charted.chart, (1 << bits, *line)) for line in real]
    known = sorted((objective.energy(q), q, line) for q, line in zip(found, real, strict=True))
    norm, levelled = squared_norm(charted.chart), charted.quartic
    # |f - mean| is at most the sum of the coefficients, of which the chart makes more.
    spread = sum(map(abs, levelled.integers)) * sum(map(abs, charted.chart)) ** 4
    width = objective.unit * Fraction(spread, 12 * norm**2)
    sines = [Fraction(3 * norm, squared_norm(q)) for _, q, _ in known]
    floors = [value - 10 * width * s for (value, _, _), s in zip(known, sines, strict=True)]
    gap, second = known[0][0] - min(floors), min(floors[1:])
    unique = 2 * known[0][0] - floors[0] < second
    equilibria = [entry for _, _, line in known for x in line for entry in (x, 0)]
    return SpringsListBody(
        quaternion=with_positive_first(known[0][1]),
        bits=bits,
        chart=charted.chart,
        lines=(*equilibria, *chain.from_iterable(pairs)),
        modulus=MODULUS,
        claims=ListClaims(
            gap=dyadic_above(gap, GAP_BITS),
            indices=_indices(levelled, [q for _, q, _ in known]),
            second=_below(second),
            sin2_half_angle=dyadic_above(sines[0], GAP_BITS) if unique else None,
            unique=True if unique else None,
        ),
        rotation_only=objective.motion.arguments["rotation_only"],
    )


def _indices(
    levelled: LevelledExactly, quaternions: Sequence[IntegerQuaternion]
) -> tuple[int, ...]:
    """How many curvatures are negative, in doubles."""
    q = np.array([[entry / math.isqrt(squared_norm(q)) for entry in q] for q in quaternions])
    curvatures: Any = np.linalg.eigvalsh(FloatingQuartic.of(levelled.rest).curvatures(q)[2])
    return tuple(int(k) for k in (curvatures < 0.0).sum(axis=1))


def _below(value: Fraction) -> Dyadic:
    """A number of few digits that is at most the value, of any sign."""
    if value >= 0:
        return dyadic_below(value, SECOND_BITS)
    above = dyadic_above(-value, SECOND_BITS)
    return Dyadic(mantissa=-above.mantissa, exponent=above.exponent)
