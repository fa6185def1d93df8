"""The rotation of least truncated squares, sought in boxes of quaternions.

min over R of sum min(r^2, 1), r = |y - R x| / bound. A box holds the q with one entry of 1 and the
others within h of its centre's. In it each residual changes by a known length, so a pair is within
its bound, beyond it, or open; a quadratic form in q bounds the cost from below. A box where that is
above the best cost known holds no optimum; one where all labels are those of the best rotation
holds none but the fit of these labels; others are cut in eight. All in doubles, box by box of one
size: a proposal, which the checker tries again in integers.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Reals = NDArray[np.float64]
    Labels = NDArray[np.int64]

MOST_BOXES = 400_000  # a few seconds with a hundred pairs
LEAST_MOVE = 2.0**-18  # of a residual in a box, in bounds: ties do not end, and its square is
# above what the cost is rounded by
AT_ONCE = 1 << 18  # pairs times boxes in memory: 8 MB an array of four numbers each
START_LEVEL, STARTS = 3, 12  # 2048 rotations, 14 degrees apart; so many are refined
WIDE = 0.25  # sin of half the angle in which a start may be off
REFITS = 50  # labels mostly stay after five
LEFT, RIGHT = np.triu_indices(4)
SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))
ROUNDING = 1e-12  # of the cost: far above the rounding of sums of ten terms


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BoxSearch(Brief):
    """The best rotation that was found, and what is known of the rotations that are as good.

    quaternion: (4,), w first, of length 1. cost: there. labels: (N,), 1 for pairs within their
    bounds at all rotations that may be as good, 0 for pairs beyond them at all, else -1.
    gap: the cost exceeds the minimum by less, as far as doubles tell. boxes: how many were looked
    at. complete: whether all ended, so that no label is open for want of time. within: (N,), which
    pairs are within their bounds at the rotation.
    """

    quaternion: Reals
    cost: float
    within: NDArray[np.bool_]
    labels: Labels
    gap: float
    boxes: int
    complete: bool


def search_boxes(source: Reals, target: Reals, bounds: Reals, *, effort: float = 1.0) -> BoxSearch:
    """The search, for points (N, 3), (N, 3) and bounds (N,) > 0; effort: a factor on its budget."""
    pairs = BoundedPairs.of(source, target, bounds)
    survey = _Survey(pairs=pairs)
    for q in _starts(pairs):
        survey.try_rotation(q)
    centres, faces, half = np.eye(4), np.arange(4), 1.0
    least = LEAST_MOVE / float(pairs.slopes.max(initial=1.0))
    while len(centres) and half > least:
        survey.boxes += len(centres)
        if survey.boxes > effort * MOST_BOXES:
            break
        rows = max(AT_ONCE // pairs.n, 1)
        parts = range(0, len(centres), rows)
        kept = [survey.undecided(centres[k : k + rows], faces[k : k + rows], half) for k in parts]
        left = np.concatenate(kept)
        centres, faces, half = *_cut(centres[left], faces[left], half), half / 2.0
    return survey.result(centres, half)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BoundedPairs(Brief):
    """Of each pair, in bounds: r^2 |q|^2 as ten coefficients (N, 10), and how far r reaches.

    lines: (N, 4, 4), of q to y q - q x, of length r |q|: without the cancellation of the forms.
    slopes: (N,), r at a centre q and in its box differ by less than h slope / |q|, as R x moves by
    at most 2 sqrt(3) h |x| / |q|.
    """

    lines: Reals
    forms: Reals
    slopes: Reals

    @classmethod
    def of(cls, source: Reals, target: Reals, bounds: Reals) -> BoundedPairs:
        """Of points and bounds."""
        x, y = source / bounds[:, np.newaxis], target / bounds[:, np.newaxis]
        lines = _quaternion_lines(x, y)
        matrices = np.matmul(lines.transpose(0, 2, 1), lines)
        forms = matrices[:, LEFT, RIGHT] * np.where(LEFT == RIGHT, 1.0, 2.0)
        sizes = np.minimum(np.linalg.norm(x, axis=1), np.linalg.norm(y, axis=1))
        return cls(lines=lines, forms=forms, slopes=2.0 * np.sqrt(3.0) * sizes)

    @property
    def n(self) -> int:
        """Number of pairs."""
        return len(self.lines)

    def squares(self, q: Reals) -> Reals:
        """(k, N): r^2 at rotations (k, 4)."""
        moved = (q / np.linalg.norm(q, axis=1)[:, np.newaxis]) @ self.lines.reshape(-1, 4).T
        moved *= moved
        return moved.reshape(len(q), -1, 4).sum(axis=2)

    def fit(self, rows: NDArray[np.bool_]) -> Reals:
        """The rotation of least sum of r^2 over some pairs."""
        return np.linalg.eigh(_matrices(self.forms[rows].sum(axis=0)))[1][:, 0]


@dataclass(slots=True, eq=False)
class _Survey:
    """The best rotation so far, and how many boxes were looked at."""

    pairs: BoundedPairs
    cost: float = np.inf
    quaternion: Reals = field(default_factory=lambda: np.array([1.0, 0.0, 0.0, 0.0]))
    within: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    boxes: int = 0

    def try_rotation(self, q: Reals) -> None:
        """Refit to the pairs within their bounds as long as these change; keep what is better."""
        before = None
        for _ in range(REFITS):
            squares = self.pairs.squares(q[np.newaxis])[0]
            cost, within = float(np.minimum(squares, 1.0).sum()), squares <= 1.0
            if cost < self.cost:
                self.cost, self.quaternion, self.within = cost, q, within
            if not within.any() or (before is not None and (within == before).all()):
                return
            before, q = within, self.pairs.fit(within)

    def undecided(self, q: Reals, faces: Labels, half: float) -> NDArray[np.bool_]:
        """(k,): which boxes may hold a rotation as good, and are not known by their labels."""
        views = _views(self.pairs, q, half)
        for best in np.argsort(views.costs)[:2]:
            if views.costs[best] < self.cost + 1.0:
                self.try_rotation(q[best])
        spare = self.cost * (1.0 + ROUNDING) - views.beyond.sum(axis=1)
        open_ = spare >= 0.0
        fits = (views.inside & self.within) | (views.beyond & ~self.within)
        open_ &= ~fits.all(axis=1)
        forms = _lifted(views.forms, -spare)
        matrices = _matrices(forms)
        slopes = 2.0 * np.einsum("kij,kj->ki", matrices, q)
        steep = np.abs(slopes)
        steep[np.arange(len(q)), faces] = 0.0
        least = np.einsum("ki,ki->k", slopes, q) / 2.0 - half * steep.sum(axis=1)
        open_ &= least <= 3.0 * half * half * np.maximum(spare, 0.0)
        open_[open_] = np.linalg.eigvalsh(matrices[open_])[:, 0] <= 0.0
        return open_

    def result(self, q: Reals, half: float) -> BoxSearch:
        """With what the boxes that are left leave open: labels, and how low the cost may be there.

        Labels are open that are so, or differ, in some of them; a form is least at its eigenvalue.
        """
        labels, gap = self.within.astype(np.int64), 0.0
        rows = max(AT_ONCE // self.pairs.n, 1)
        for start in range(0, len(q), rows):
            views = _views(self.pairs, q[start : start + rows], half)
            agree = np.where(self.within, views.inside, views.beyond).all(axis=0)
            labels[~agree] = -1
            lowest = np.linalg.eigvalsh(_matrices(views.forms))[:, 0] + views.beyond.sum(axis=1)
            gap = max(gap, self.cost - float(lowest.min()))
        return BoxSearch(
            quaternion=self.quaternion,
            cost=self.cost,
            within=self.within,
            labels=labels,
            gap=gap,
            boxes=self.boxes,
            complete=len(q) == 0,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Views(Brief):
    """Boxes: which pairs (k, N) are inside or beyond, and a form (k, 10) that bounds the others.

    The sum of min(r^2, 1) over the pairs that are not beyond is at least form(q) / |q|^2 in the
    box: an open pair has r <= s, s > 1, so min(r^2, 1) >= r^2 / s^2. costs: (k,), at the centres.
    """

    inside: NDArray[np.bool_]
    beyond: NDArray[np.bool_]
    forms: Reals
    costs: Reals


def _views(pairs: BoundedPairs, q: Reals, half: float) -> _Views:
    sizes = np.linalg.norm(q, axis=1)[:, np.newaxis]
    squares = pairs.squares(q)
    r, moves = np.sqrt(squares), half * pairs.slopes / sizes
    beyond, inside = r - moves > 1.0, r + moves <= 1.0
    chords = 1.0 / np.maximum(r + moves, 1.0) ** 2
    weights = np.where(beyond, 0.0, chords)
    return _Views(
        inside=inside,
        beyond=beyond,
        forms=weights @ pairs.forms,
        costs=np.minimum(squares, 1.0).sum(axis=1),
    )


def _starts(pairs: BoundedPairs) -> list[Reals]:
    """The best of 2048 rotations by bounds as wide as they are apart, which then shrink."""
    ticks = (np.arange(1, 2 << START_LEVEL, 2) - (1 << START_LEVEL)) / (1 << START_LEVEL)
    grid = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1).reshape(-1, 3)
    centres = np.concatenate([np.insert(grid, face, 1.0, axis=1) for face in range(4)])
    wide = np.maximum(1.0, WIDE * pairs.slopes / np.sqrt(3.0)) ** 2
    costs = np.empty(len(centres))
    rows = max(AT_ONCE // pairs.n, 1)
    for start in range(0, len(centres), rows):
        squares = pairs.squares(centres[start : start + rows])
        costs[start : start + rows] = np.minimum(squares / wide, 1.0).sum(axis=1)
    return [_annealed(pairs, centres[k], wide) for k in np.argsort(costs, kind="stable")[:STARTS]]


def _annealed(pairs: BoundedPairs, q: Reals, wide: Reals) -> Reals:
    """A rotation refitted to the pairs within wide bounds, and within smaller ones."""
    limits = wide
    while (limits > 1.0).any():
        near = pairs.squares(q[np.newaxis])[0] <= limits
        if near.any():
            q = pairs.fit(near)
        limits = np.maximum(limits / 2.0, 1.0)
    return q


def _cut(q: Reals, faces: Labels, half: float) -> tuple[Reals, Labels]:
    """The eight halves of each box."""
    steps = np.zeros((len(q), 8, 4))
    for face in range(4):
        of_face = faces == face
        steps[of_face] = np.insert(SIGNS * (half / 2.0), face, 0.0, axis=1)
    return (q[:, np.newaxis] + steps).reshape(-1, 4), np.repeat(faces, 8)


def _quaternion_lines(x: Reals, y: Reals) -> Reals:
    """(N, 4, 4): q to y q - q x, of length |q| |y - R(q) x|."""
    lines = np.zeros((len(x), 4, 4))
    lines[:, 0, 1:], lines[:, 1:, 0] = x - y, y - x
    (a, b, c), blocks = (y + x).T, lines[:, 1:, 1:]
    blocks[:, 0, 1], blocks[:, 0, 2], blocks[:, 1, 2] = -c, b, -a
    blocks[:, 1, 0], blocks[:, 2, 0], blocks[:, 2, 1] = c, -b, a
    return lines


def _matrices(forms: Reals) -> Reals:
    """(..., 4, 4): the symmetric matrices of forms (..., 10)."""
    matrices = np.empty((*forms.shape[:-1], 4, 4))
    matrices[..., LEFT, RIGHT] = matrices[..., RIGHT, LEFT] = forms * np.where(
        LEFT == RIGHT, 1.0, 0.5
    )
    return matrices


def _lifted(forms: Reals, by: Reals) -> Reals:
    """The forms plus so many times |q|^2."""
    return forms + by[:, np.newaxis] * (LEFT == RIGHT)
