"""The equilibria of a body on springs that break, set by set of unbroken springs.

V = sum of min(w r_i^2, w b_i^2) has near a pose with |r_i| != b_i for all i the form

    V_S = sum over S of w r_i^2 + sum over the others of w b_i^2,    S = the i with |r_i| < b_i,

and so its equilibria are those of V_S, the eigenspaces of the Davenport matrix of S, with just the
labels S: the springs of S within their bounds, the others beyond. Labels are decided in integers:
with `sin2` of an eigenline the exact residual differs from the one at the integer quaternion by at
most 2 sin |x - mean|, and a spring whose bound lies in that range is named, not guessed.

On a tie, |r_i| = b_i for some i, no minimum of V lies: V is there at most V_T and V_U, T and U with
and without the spring, and equal to both, so that both gradients would be zero at a minimum. But
they differ by that of w r_i^2, which is -2 w r_i != 0 in the translation. Proof: derivations,
springs_that_break.

Which sets may hold at one pose: where springs i and j both hold, the difference of their residuals
is shorter than b_i + b_j, and the lengths |x_j - x_i| and |y_j - y_i| differ by less. So a set that
holds is a clique in the graph of the pairs that pass this test, decided in integers; a set of at
least k has its springs where each has k - 1 neighbours; and a set that never holds, for its least
energy is too large, is part of none that does.

How far the integer quaternion of an eigenspace is from the exact one is proved in integers, too.
Between two eigenspaces of K a number m is chosen, and the eigenvalues above it are counted exactly,
by Descartes' rule on the characteristic polynomial of K - m I. Where one eigenvalue l lies between
two such numbers it is simple, and its index is the number above. Let v be the Rayleigh quotient of
a unit vector p = c u + s w, u the eigenvector, w a unit vector in the span of the three others,
whose eigenvalues are all at least g away from v. Then |K p - v p| >= |s| |K w - v w| >= |s| g, so

    sin^2(p, u) = s^2 <= |K p - v p|^2 / g^2,

and R(p) is within twice that angle of the exact rotation. Likewise an eigenvalue is no further from
v than |K p - v p|, and where that is less than g it is l. Source: [Davis1970].
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import isqrt
from typing import TYPE_CHECKING

from certreg._loading import cached_property
from certreg.errors import UndecidedError
from certreg.exact.dyadic import power_of_two, rational_root_above
from certreg.exact.signs import signs_of_eigenvalues
from certreg.geometry.so3 import Vector3, dot, rotation_matrix, squared_norm
from certreg.native.bitset_graph import rows_of
from certreg.objective.isotropic import Isotropic
from certreg.problem.lifting import ExactSprings, exact_springs
from certreg.results import Brief, ComponentKind

if TYPE_CHECKING:
    from fractions import Fraction

    from certreg.exact.spaces import IntegerQuaternion
    from certreg.problem.problem import RegistrationProblem


LEAST_SPRINGS = 3  # two hold the body in no pose: it turns about their line
LARGEST_TRIED = 12  # springs of a set that is tried with all larger ones: more seldom refute
BRANCHES_A_SET = 16  # of the search, each quicker than a set: those without an end are given up


@dataclass(frozen=True, slots=True, kw_only=True)
class Eigenline(Brief):
    """An eigenspace of K, its place among them proved.

    quaternion: near it, in integers. index: number of eigenvalues above its own. sin2: of a point,
    at least sin^2 of the angle between `quaternion` and it, which is half the angle of rotation;
    None of a continuum. error: the eigenvalue is no further from that of `quaternion`.
    """

    quaternion: IntegerQuaternion
    kind: ComponentKind
    index: int
    sin2: Fraction | None
    error: Fraction


def eigenlines(objective: Isotropic) -> tuple[Eigenline, ...]:
    """All eigenspaces of K, largest eigenvalue first.

    Raises UndecidedError where 3,700 digits do not tell two eigenvalues apart.
    """
    resolution, shape = objective.eigenspaces, objective.classification
    values = [space.value for space in resolution.spaces]
    middles = [upper + lower for upper, lower in pairwise(values)]  # twice the numbers between
    for middle, above in zip(middles, shape.indices[1:], strict=True):
        if not _splits(objective, middle, above):
            raise UndecidedError(
                "two eigenvalues of the Davenport matrix are too close to be told apart",
                method="spectral",
            )
    half = objective.eigenvalue_unit / 2
    marks = [None, *[middle * half for middle in middles], None]
    parts = zip(resolution.quaternions, shape.pattern, shape.indices, pairwise(marks), strict=True)
    return tuple(_eigenline(objective, *part) for part in parts)


def energy_is_at_least(objective: Isotropic, bound: Fraction) -> bool:
    """Whether the least energy over all poses, s - 2 l1, is at least `bound`: exact, no root."""
    highest = (objective.moments.spread - bound) / (2 * objective.moments.cross_unit)
    up, shift = highest.denominator, highest.numerator
    return signs_of_eigenvalues(_shifted(objective, up, shift)).positive == 0


def _splits(objective: Isotropic, middle: int, above: int) -> bool:
    """Whether so many eigenvalues of K are above middle / 2, in fixed point, and none is there."""
    places = objective.shift - objective.eigenspaces.bits - 1
    up, down = max(places, 0), max(-places, 0)
    signs = signs_of_eigenvalues(_shifted(objective, 1 << down, middle << up))
    return signs.positive == above and not signs.zero


def _shifted(objective: Isotropic, times: int, shift: int) -> list[list[int]]:
    """The matrix times K - shift I."""
    return [
        [times * entry - (shift if i == j else 0) for j, entry in enumerate(row)]
        for i, row in enumerate(objective.davenport)
    ]


def _eigenline(
    objective: Isotropic,
    q: IntegerQuaternion,
    many: int,
    index: int,
    between: tuple[Fraction | None, Fraction | None],
) -> Eigenline:
    """The only eigenspace between two numbers, near a quaternion."""
    value, square = objective.alignment(q), objective.squared_residual(q)
    upper, lower = between
    gaps = [upper - value] if upper is not None else []
    gaps += [value - lower] if lower is not None else []
    error = rational_root_above(square)
    if any(gap <= error for gap in gaps):
        raise UndecidedError(
            "an eigenvector of the Davenport matrix was not found to the precision asked for",
            method="spectral",
        )
    return Eigenline(
        quaternion=q,
        kind=ComponentKind.of_multiplicity(many),
        index=index,
        sin2=square / min(gaps) ** 2 if many == 1 else None,
        error=error,
    )


class Labels(enum.Enum):
    """What is decided of the springs at a rest pose; the value is the sentence for users."""

    PROVED = "Just these springs hold, all others are broken: proved in integers."
    TIED = "The residual of a spring equals its bound: an equilibrium is not defined, no minimum."
    TOO_NEAR = "The residual of a spring is nearer to its bound than a billionth of a billionth."
    CONTINUUM = "The rest poses form a continuum, and springs may break along it: not decided."


@dataclass(frozen=True, slots=True, kw_only=True)
class RestPose(Brief):
    """A rest pose of the body on one set of springs, or a continuum of them.

    unbroken: the rows of the set, ascending. index: number of independent directions in which the
    energy falls. energy: V at `quaternion`, exactly, in objective units. doubtful: the rows whose
    labels are not proved, of a tie those on it; of a continuum at its member nearest to the
    identity, which may have none.
    """

    unbroken: tuple[int, ...]
    quaternion: IntegerQuaternion
    kind: ComponentKind
    index: int
    energy: Fraction
    labels: Labels
    doubtful: tuple[int, ...]


class SpringSet:
    """Some springs of a problem as if they did not break: their objective, and rest poses."""

    def __init__(self, problem: RegistrationProblem, unbroken: tuple[int, ...]) -> None:
        self.problem, self.unbroken = problem, unbroken

    @cached_property
    def objective(self) -> Isotropic:
        """The energy of these springs alone."""
        return Isotropic.of(self.problem.of_rows(self.unbroken))

    @property
    def rows(self) -> ExactSprings:
        """All springs of the problem in integers."""
        return exact_springs(self.problem)

    @property
    def never_holds(self) -> bool:
        """Whether it is proved that at no pose all these springs are within their bounds.

        There sum w r^2 < sum w b^2, so it is where the least of the left side is not less. Then no
        larger set holds either. False: not proved.
        """
        return energy_is_at_least(self.objective, self._most)

    @cached_property
    def _most(self) -> Fraction:
        """More than these springs have where they hold: what they have once they break."""
        rows = self.rows
        return sum(rows.broken(i) for i in self.unbroken) * power_of_two(rows.exponent)

    def rest_poses(self) -> Iterator[RestPose]:
        """Those at which no spring is proved to have another label than in this set."""
        broken = self.rows.broken_energy(self.unbroken)
        for line in eigenlines(self.objective):
            labels = self._labels(line)
            if labels is not None:
                verdict, doubtful = labels
                yield RestPose(
                    unbroken=self.unbroken,
                    quaternion=line.quaternion,
                    kind=line.kind,
                    index=line.index,
                    energy=self.objective.energy(line.quaternion) + broken,
                    labels=verdict,
                    doubtful=doubtful,
                )

    def _labels(self, line: Eigenline) -> tuple[Labels, tuple[int, ...]] | None:
        """What is proved of the springs at an eigenspace, and the rows that this leaves open.

        None: one has another label.
        """
        energy = self.objective.energy(line.quaternion)
        if energy - 2 * line.error >= self._most:
            return None
        residuals = _Residuals(self.rows, self.unbroken, line, energy + 2 * line.error)
        kept, doubtful, verdict = set(self.unbroken), list[int](), Labels.PROVED
        others = [i for i in range(self.problem.n) if i not in kept]
        for i in (*self.unbroken, *others):
            low, high, bound = residuals.between(i)
            if high < bound if i in kept else low > bound:
                continue
            if low > bound if i in kept else high < bound:
                return None
            doubtful.append(i)
            if low < high and verdict is not Labels.TOO_NEAR:
                verdict = Labels.TOO_NEAR
            elif verdict is Labels.PROVED:
                verdict = Labels.TIED
        if doubtful and line.sin2 is None:
            verdict = Labels.CONTINUUM
        return verdict, tuple(sorted(doubtful))


class _Residuals:
    """Residuals at the exact rotations of an eigenspace and the best translation, in integers.

    With the mass M, the means X, Y of the set times M, and n = |q|^2, the lengths are over M n.
    """

    def __init__(
        self, rows: ExactSprings, unbroken: tuple[int, ...], line: Eigenline, energy: Fraction
    ) -> None:
        self._rows, self._unbroken, self._line, self._energy = rows, unbroken, line, energy
        weights = [rows.weights[i] for i in unbroken]
        self._mass, self._norm = sum(weights), squared_norm(line.quaternion)
        self._source = _sum(weights, [rows.sources[i] for i in unbroken])
        self._target = _sum(weights, [rows.targets[i] for i in unbroken])
        self._turn = rotation_matrix(line.quaternion)

    def between(self, row: int) -> tuple[int, int, int]:
        """Two bounds of the residual, and the length at which the spring breaks.

        In a continuum those of all rotations, | |y| - |x| | and |y| + |x| about the means, and of a
        spring of the set sqrt(E / w), E the energy of the set, which is the same all along it.
        """
        rows, mass, norm = self._rows, self._mass, self._norm
        x = [mass * k - mean for k, mean in zip(rows.sources[row], self._source, strict=True)]
        y = [mass * k - mean for k, mean in zip(rows.targets[row], self._target, strict=True)]
        bound = rows.bounds[row] * mass * norm
        if self._line.sin2 is None:
            (a, c), (b, d) = (_roots(squared_norm(v) * norm**2) for v in (x, y))
            return max(0, a - d, b - c), min(c + d, self._longest(row, c + d)), bound
        ends = [norm * k - dot(turn, x) for k, turn in zip(y, self._turn, strict=True)]
        low, high = _roots(squared_norm(ends))
        turned = 4 * norm**2 * squared_norm(x) * self._line.sin2  # (2 sin |x|)^2
        _, slack = _roots(-(-turned.numerator // turned.denominator))
        return low - slack, high + slack, bound

    def _longest(self, row: int, otherwise: int) -> int:
        """The residual of a spring of the set that has all its energy."""
        if row not in self._unbroken:
            return otherwise
        square = self._energy * (self._mass * self._norm) ** 2 / self._rows.weights[row]
        square /= power_of_two(self._rows.exponent)
        return _roots(-(-square.numerator // square.denominator))[1]


def _sum(weights: list[int], points: list[Vector3[int]]) -> list[int]:
    columns = zip(*points, strict=True)
    return [sum(w * k for w, k in zip(weights, column, strict=True)) for column in columns]


def _roots(square: int) -> tuple[int, int]:
    """The integers next to a square root, below and above; the same of a perfect square."""
    below = isqrt(square)
    return below, below + (below * below < square)


def consistent_springs(problem: RegistrationProblem) -> list[int]:
    """For each spring those that may hold at one pose with it, as bits of an integer."""
    near, rows = [0] * problem.n, exact_springs(problem)
    for j in range(problem.n):
        for i in range(j):
            if _agree(rows, i, j):
                near[i] |= 1 << j
                near[j] |= 1 << i
    return near


def label_sets(problem: RegistrationProblem, least: int, most_sets: int) -> Iterator[SpringSet]:
    """All sets of at least `least` >= 3 springs that may hold: cliques that are not refuted.

    Raises UndecidedError where more than `most_sets` sets would have to be looked at.
    """
    yield from _Sets(problem, least, most_sets).all()


@dataclass(frozen=True, slots=True)
class _Branch:
    """The sets of all of `taken` and some of `open`; last: of `taken`, where it was looked at."""

    taken: tuple[int, ...]
    open: int
    last: SpringSet | None


class _Sets:
    """A search through the cliques: each spring in turn is taken, or left out."""

    def __init__(self, problem: RegistrationProblem, least: int, most_sets: int) -> None:
        self._problem, self._least = problem, least
        self._most = self._left = most_sets
        self._branches_left = BRANCHES_A_SET * most_sets + problem.n
        self._near = consistent_springs(problem)

    def all(self) -> Iterator[SpringSet]:
        branches = [_Branch((), (1 << self._problem.n) - 1, None)]
        while branches:
            branch = branches.pop()
            self._count_branch()
            taken, free = branch.taken, self._linked(branch)
            if len(taken) + free.bit_count() < self._least:
                continue
            if not free:
                yield branch.last or self._looked_at(taken)
                continue
            first = free & -free
            row = first.bit_length() - 1
            branches.append(_Branch(taken, free ^ first, branch.last))
            more = (*taken, row)
            grown = self._looked_at(more) if LEAST_SPRINGS <= len(more) <= LARGEST_TRIED else None
            if grown is None or not grown.never_holds:
                branches.append(_Branch(more, free & self._near[row], grown))

    def _linked(self, branch: _Branch) -> int:
        """The free springs, less those with too few neighbours for a set that is large enough."""
        free, needed = branch.open, self._least - len(branch.taken) - 1
        while needed > 0:
            few = [i for i in rows_of(free) if (self._near[i] & free).bit_count() < needed]
            if not few:
                break
            free &= ~sum(1 << i for i in few)
        return free

    def _count_branch(self) -> None:
        if not self._branches_left:
            raise self._too_many
        self._branches_left -= 1

    def _looked_at(self, rows: tuple[int, ...]) -> SpringSet:
        if not self._left:
            raise self._too_many
        self._left -= 1
        return SpringSet(self._problem, rows)

    @property
    def _too_many(self) -> UndecidedError:
        message = (
            f"more than {self._most} sets of springs may hold together: give narrower bounds, "
            "ask for more unbroken springs (`least`), or for more sets (`most_sets`)"
        )
        return UndecidedError(message, method="label sets")


def _agree(rows: ExactSprings, i: int, j: int) -> bool:
    """Whether | |x_j - x_i| - |y_j - y_i| | < b_i + b_j = d, in integers and without a root.

    With A >= B the squared lengths it is so iff A - B - d^2 < 2 d sqrt(B).
    """
    x, y = (
        squared_norm([q - p for p, q in zip(points[i], points[j], strict=True)])
        for points in (rows.sources, rows.targets)
    )
    A, B, d = max(x, y), min(x, y), rows.bounds[i] + rows.bounds[j]
    excess = A - B - d * d
    return excess < 0 or excess * excess < 4 * d * d * B
