"""Producing a certificate of kind "springs-sos": squares that an exact elimination accepts.

With m the ten products q_i q_j, F - level |q|^4 - mu (|q|^4 - (u.q)^4) = m^T G m for
a positive definite G proves that the objective grows from the pose u as mu sin^2(angle/2). Twenty
entries of G are free, and a solver of the relaxation proposes them, to about eight digits. Here
they are made better: moved, by least squares, to where G m(u) = 0, which the optimum needs. What is
left of it, rho, costs a gap of rho^2 over the next eigenvalue. Exact elimination decides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from certreg.certificate.pose_claims import PoseBody, PoseClaims
from certreg.certificate.radius import Radius
from certreg.errors import InvalidProblemError
from certreg.exact.decimals import at_least, at_most
from certreg.exact.dyadic import Dyadic, dyadic_above, power_of_two
from certreg.exact.elimination import is_positive_definite
from certreg.geometry.so3 import dot, squared_norm
from certreg.verify import BITS, BLOCK, NEAR

if TYPE_CHECKING:
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem
    from certreg.relaxation.optimum import Found


Array = NDArray[np.float64]

INLINE_SPRINGS = 700_000  # points, 128 bytes each in base64: files are below 1e8 bytes

QUARTICS: tuple[tuple[int, ...], ...] = tuple(combinations_with_replacement(range(4), 4))
PRODUCTS = tuple(combinations_with_replacement(range(4), 2))
SQUARE = tuple((1 + (a < c)) * (a == b and c == d) for a, b, c, d in QUARTICS)  # of |q|^4
TIMES = tuple(
    24 // math.prod(math.factorial(m.count(i)) for i in range(4)) for m in QUARTICS
)  # of (u.q)^4
# Of the entries of G on and above the diagonal, by the monomial that each goes into: the first has
# what the others leave, and these are free.
MONOMIALS = {
    (i, j): tuple(sorted(PRODUCTS[i] + PRODUCTS[j]))
    for i, j in combinations_with_replacement(range(10), 2)
}
FIRST = {monomial: entry for entry, monomial in reversed(MONOMIALS.items())}
FREE = {entry: monomial for entry, monomial in MONOMIALS.items() if FIRST[monomial] != entry}
LENGTHS = np.array([1.0 + (i < j) for i, j in PRODUCTS])  # |q|^4 = sum of them times (q_i q_j)^2
ROUNDING = 70  # two parts of each coefficient are rounded down, and |q_i q_j q_k q_l| <= 1
BOUND_BITS = 32  # mantissa of what is claimed: short numbers, at most 2^-31 wasted
RANGE_BITS = 112  # of the range of F: far below 256, which the checker allows
FREE_BITS = 53  # of the entries that are free: rho near 2^-53, so gaps near 2^-106 / eigenvalue
POSE_BITS = 59  # of the quaternion: it costs as much
POLISHING_STEPS = 3  # each gains the digits of a double
FLAT = 1e-13  # of the largest eigenvalue: below, rounding hides the next one; exact tests decide
LEAST_DELTA = 64 * ROUNDING  # coefficients rounded down by less than 2: |entries of G| <= 4
MORE = 1 + 2.0**-20  # of what doubles say of an eigenvalue, relative to itself
ATTEMPTS = 12
GROWTH_BITS = 8  # of delta after a refused attempt


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsBody(PoseBody):
    """A proof that a pose of general springs is optimal.

    symmetry: turns (a, b) of world and body that keep the objective; where there are many optima.
    radius: how far points may move before an optimum turns by more than an angle.
    rotation_only: of a problem without a translation.
    """

    INLINE: ClassVar[int] = INLINE_SPRINGS
    PLACES: ClassVar = {
        "quaternion": "proof.pose",
        "symmetry": "proof.symmetry",
        "radius": "radius?",
        "rotation_only": "rotation_only?",
    }

    symmetry: Annotated[tuple[int, ...], (6,)] | None = None
    radius: Radius | None = None
    rotation_only: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsSosBody(SpringsBody):
    """A proof that a pose of general springs is optimal: integers over 2^unit, and what follows.

    level, mu: the objective exceeds level + mu sin^2(theta/2), theta the angle to that rotation.
    gram: the twenty entries of the Gram matrix that its identity leaves free, and k: over
        2^(unit + k).
    """

    KIND: ClassVar[str] = "springs-sos"
    PLACES: ClassVar = {
        **SpringsBody.PLACES,
        "unit": "proof.unit",
        "level": "proof.level",
        "mu": "proof.mu",
        "gram": "proof.gram",
    }

    unit: int
    level: int
    mu: int
    gram: Annotated[tuple[int, ...], (21,)]

    @property
    def growth(self) -> Fraction:
        """The objective exceeds its value here less `gap` by this times sin^2(theta/2)."""
        return Dyadic(mantissa=self.mu, exponent=self.unit).value


def require_near(problem: RegistrationProblem) -> None:
    """Refuses points of sizes so far apart that the checker takes no sums of them.

    It splits `BLOCK` rows at a time into integers times one power of two, at most 1.
    """
    for first in range(0, problem.n, BLOCK):
        block = problem.block(slice(first, first + BLOCK))
        least, most = zip(_ends(block.source), _ends(block.target), strict=True)
        lows, tops = ([math.frexp(end)[1] - 53 for end in ends] for ends in (least, most))
        tops = [a if b - a <= NEAR else b for a, b in zip(lows, tops, strict=True)]  # one size
        if max(tops) - min(0, *lows) > 3 * BITS:
            raise InvalidProblemError(
                f"the clouds hold numbers from {at_least(min(least))} to {at_most(max(most))}: "
                "beside normals, directions or matrices proofs would be too long; give the clouds "
                "in a unit in which they are nearer to 1, and 0 for numbers that are nothing but "
                "rounding",
                array="source",
                value=max(most),
            )


def _ends(points: Array) -> tuple[float, float]:
    """The least and the largest size of numbers other than 0; 0 where there are none."""
    sizes = np.abs(points[points != 0.0])
    return (float(sizes.min()), float(sizes.max())) if len(sizes) else (0.0, 0.0)


def sos_body(objective: Springs, found: Found) -> SpringsSosBody | None:
    """The body of a certificate; None where no attempt passed the exact test.

    found: the optimum to many bits, and the solver's G for F - value |q|^4. Where that value is not
    the optimum's, or other directions cost nothing, a gap is what is left. None means not proved,
    not disproved.
    """
    if found.relaxation.gram is None and not found.levelled.is_constant:
        return None
    scaled = _Scaled.of(objective, found)
    proposed = scaled.integers_of(objective, found)
    start = scaled.polished(proposed, mu=0)
    least, second, *_, largest = scaled.eigenvalues(start)
    if second > FLAT * largest:
        mu = int(second / 2)
        short = _Short.of(scaled.polished(scaled.with_growth(start, mu), mu))
        rho = float(np.linalg.norm(scaled.residual(short.entries, mu))) / 2
        delta = LEAST_DELTA + int(4 * rho**2 / (float(second) - mu))
        proved = _proved(scaled, short, mu, delta, growth=GROWTH_BITS)
        if proved is not None:
            return _body(objective, scaled, short, mu=mu, delta=proved)
    loss = float(scaled.eigenvalues(proposed)[0])
    best, loss = (start, float(least)) if least > loss else (proposed, loss)
    delta = LEAST_DELTA + int(max(-loss, FLAT * float(largest)) * MORE)
    short = _Short.of(best)
    proved = _proved(scaled, short, 0, delta, growth=1)
    return None if proved is None else _body(objective, scaled, short, mu=0, delta=proved)


def _proved(scaled: _Scaled, short: _Short, mu: int, delta: int, *, growth: int) -> int | None:
    """The first delta that passes the exact test; it grows by so many bits at a time."""
    for attempt in range(ATTEMPTS):
        grown = delta << growth * attempt
        if is_positive_definite(scaled.matrix(short.entries, mu, grown)):
            return grown
    return None


def _body(
    objective: Springs, scaled: _Scaled, short: _Short, *, mu: int, delta: int
) -> SpringsSosBody:
    """With all claims that follow, by the rules of the checker."""
    one, level = scaled.one, scaled.value - delta
    gap = objective.energy(scaled.quaternion) - (level - ROUNDING) * one
    pairs = zip(scaled.quartic, SQUARE, strict=True)
    width = sum([abs(c - level * k) for c, k in pairs]) + 2 * ROUNDING
    claims, symmetry = growth_claims(objective, gap, mu * one, width * one)
    return SpringsSosBody(
        quaternion=scaled.quaternion,
        unit=scaled.unit,
        level=level,
        mu=mu,
        gram=(*short.mantissas, short.exponent),
        claims=claims,
        symmetry=symmetry,
        rotation_only=objective.motion.arguments["rotation_only"],
    )


def growth_claims(
    objective: Springs, gap: Fraction, mu: Fraction, width: Fraction
) -> tuple[PoseClaims, tuple[int, ...] | None]:
    """What follows where the objective grows from the pose as mu sin^2(angle/2), less the gap.

    And the symmetry by which the optimum is none alone. width: at least the range of the objective.
    """
    unique, symmetry = None, None
    if mu and 4 * max(width, 2 * mu) * gap <= mu**2:
        unique = True
    elif not mu:
        symmetry = next((turns for turns in objective.symmetry if _moves_all(turns)), None)
        unique = None if symmetry is None else False
    angle = dyadic_above(gap / mu, BOUND_BITS) if gap < mu else None
    claims = PoseClaims(gap=dyadic_above(gap, BOUND_BITS), sin2_half_angle=angle, unique=unique)
    return claims, symmetry


def _shortened(quaternion: Sequence[int]) -> tuple[int, int, int, int]:
    """The same line, to `POSE_BITS` bits."""
    cut = max(max(abs(entry) for entry in quaternion).bit_length() - POSE_BITS, 0)
    half = 1 << cut >> 1
    w, x, y, z = (entry + half >> cut for entry in quaternion)
    return (w, x, y, z)


def _moves_all(turns: Sequence[int]) -> bool:
    """Whether q' = a q + q b moves every rotation: a and b are of different lengths."""
    return squared_norm(turns[:3]) != squared_norm(turns[3:])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Short:
    """The free entries, of few bits: mantissas times 2^exponent."""

    mantissas: tuple[int, ...]
    exponent: int

    @classmethod
    def of(cls, entries: Sequence[int]) -> _Short:
        exponent = max(max(abs(entry) for entry in entries).bit_length() - FREE_BITS, 0)
        half = 1 << exponent >> 1
        return cls(
            mantissas=tuple(entry + half >> exponent for entry in entries), exponent=exponent
        )

    @property
    def entries(self) -> list[int]:
        return [mantissa << self.exponent for mantissa in self.mantissas]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Scaled:
    """The objective in units of 2^unit, its coefficients rounded down, and the pose.

    value: of the objective there, rounded down. products: of the pose of unit length, over
    2^RANGE_BITS.
    """

    unit: int
    quartic: tuple[int, ...]
    quaternion: tuple[int, int, int, int]
    value: int
    products: tuple[int, ...]

    @property
    def one(self) -> Fraction:
        return power_of_two(self.unit)

    @classmethod
    def of(cls, objective: Springs, found: Found) -> _Scaled:
        quaternion = _shortened(found.quaternion)
        levelled = found.levelled
        size = objective.unit * max(levelled.scale, abs(levelled.level) / (1 << RANGE_BITS))
        unit = size.numerator.bit_length() - size.denominator.bit_length() - RANGE_BITS
        over = objective.unit / power_of_two(unit)
        norm = squared_norm(quaternion)
        return cls(
            unit=unit,
            quartic=tuple(c * over.numerator // over.denominator for c in objective.quartic),
            quaternion=quaternion,
            value=math.floor(objective.value(quaternion) * over / norm**2),
            products=tuple(
                (quaternion[i] * quaternion[j] << RANGE_BITS) // norm for i, j in PRODUCTS
            ),
        )

    def integers_of(self, objective: Springs, found: Found) -> list[int]:
        """The free entries that the solver proposes, for F: its G is for F - its value |q|^4."""
        levelled, relaxation = found.levelled, found.relaxation
        over = objective.unit / self.one
        gram: Any = relaxation.gram
        if gram is None:  # of a constant
            gram, value = np.zeros((10, 10)), self.value
        else:
            least = levelled.scale * Fraction(relaxation.value or 0) + levelled.level
            value = min(self.value, math.floor(least * over))
        scale = float(levelled.scale * over)
        return [
            round(float(gram[i, j]) * (1 + (i < j)) * scale) + 2 * value * (i == j) for i, j in FREE
        ]

    def coefficients(self, mu: int) -> list[int]:
        """Of F + mu (u.q)^4, as the checker rounds them."""
        q, norm = self.quaternion, squared_norm(self.quaternion) ** 2
        return [
            c + (times * mu * q[a] * q[b] * q[i] * q[j]) // norm
            for c, times, (a, b, i, j) in zip(self.quartic, TIMES, QUARTICS, strict=True)
        ]

    def matrix(self, free: Sequence[int], mu: int, delta: int = 0) -> list[list[int]]:
        """2 G, 10x10, with these free entries; (level + mu) |q|^4 is on the diagonal."""
        left = dict(zip(QUARTICS, self.coefficients(mu), strict=True))
        rows = [[0] * 10 for _ in range(10)]
        for ((i, j), monomial), entry in zip(FREE.items(), free, strict=True):
            rows[i][j] = rows[j][i] = entry
            left[monomial] -= entry
        for monomial, (i, j) in FIRST.items():
            rows[i][j] = rows[j][i] = left[monomial]
        for k, (i, j) in enumerate(PRODUCTS):
            rows[k][k] = 2 * (rows[k][k] - (1 + (i < j)) * (self.value - delta + mu))
        return rows

    def residual(self, free: Sequence[int], mu: int) -> Array:
        """2 G m(u), in doubles of an exact product."""
        rows = self.matrix(free, mu)
        return np.array([dot(row, self.products) / (1 << RANGE_BITS) for row in rows])

    def polished(self, free: Sequence[int], mu: int) -> list[int]:
        """The free entries moved, as little as will do, to where G m(u) = 0."""
        found = list(free)
        inverse = _pseudo_inverse([entry / (1 << RANGE_BITS) for entry in self.products])
        for _ in range(POLISHING_STEPS):
            step = inverse @ self.residual(found, mu)
            found = [entry - round(float(s)) for entry, s in zip(found, step, strict=True)]
        return found

    def eigenvalues(self, free: Sequence[int]) -> Array:
        """Of G, m of unit length where q is; in doubles, ascending."""
        rows = np.array([[float(entry) for entry in row] for row in self.matrix(free, 0)]) / 2
        found: Any = np.linalg.eigvalsh(rows / np.sqrt(np.outer(LENGTHS, LENGTHS)))
        return found

    def with_growth(self, free: Sequence[int], mu: int) -> list[int]:
        """The free entries and those of mu (u.q)^4, as the square of a linear form."""
        p = [(1 + (i < j)) * entry for (i, j), entry in zip(PRODUCTS, self.products, strict=True)]
        return [
            entry + (mu * p[i] * p[j] * (1 + (i < j)) >> 2 * RANGE_BITS)
            for (i, j), entry in zip(FREE, free, strict=True)
        ]


def _pseudo_inverse(products: Sequence[float]) -> Array:
    """(20, 10): from 2 G m to the least change of the free entries that makes it."""
    image = np.zeros((10, 20))
    for k, (entry, monomial) in enumerate(FREE.items()):
        for (a, b), sign in ((entry, 1.0), (FIRST[monomial], -1.0)):
            image[a, k] += sign * products[b]
            image[b, k] += sign * products[a]
    found: Any = np.linalg.pinv(image, rcond=1e-9)
    return found
