"""What the checker must say of two rows that are struck together: boundaries, in exact numbers.

The rows that each turn may meet are compared with the definition in 40 digits; rows that one motion
meets, with residuals on their bounds, must stay together also in frames of a few bits, where every
rounding is large.
"""

from __future__ import annotations

from itertools import combinations, permutations
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
from checker_boundaries import Case, value_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

Row = list[int]
DIGITS = 40
ONE = 1 << 70  # of lengths: roundings of 2^-64 are far below what is asked
INSIDE = 1 << 18  # of 2^70: 2^-52
QUARTER = 32
AXIS = (17, 29, 43)
MANY = 10**9  # looks


def row(x: Sequence[int], y: Sequence[int], bound: int) -> Row:
    return [*map(int, x), *map(int, y), 1, int(bound)]


def edge_graph(n: int, edges: Sequence[tuple[int, int]]) -> list[int]:
    near = [0] * n
    for i, j in edges:
        near[i] |= 1 << j
        near[j] |= 1 << i
    return near


def complete(n: int) -> list[int]:
    return edge_graph(n, [*combinations(range(n), 2)])


# --- Turns: the definition ------------------------------------------------------------------------


def axes_of(a: Any) -> Any:
    """The frame: across `a` and AXIS, across both, along a."""
    first, last = _unit(_cross(a, AXIS)), _unit(a)
    return first, _cross(last, first), last


def _unit(v: Any) -> Any:
    size = mpmath.sqrt(sum(k * k for k in v))
    return [k / size for k in v]


def _cross(a: Any, b: Any) -> Any:
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def _dot(a: Any, b: Any) -> Any:
    return sum(p * q for p, q in zip(a, b, strict=True))


def misses(rows: Sequence[Row], e: int, f: int, k: int) -> list[Any]:
    """For each turn how far R_m p is off from q, more than a motion may be that meets all three."""
    with mpmath.workdps(DIGITS):
        o = rows[e]
        (a, b), (p, q) = (
            [[mpmath.mpf(g - h) for g, h in zip(rows[i][at], o[at], strict=True)] for at in SIDES]
            for i in (f, k)
        )
        size, width = (mpmath.sqrt(_dot(v, v)) for v in (a, b))
        reach = o[7] + rows[f][7]
        chord = mpmath.sqrt((reach**2 - (size - width) ** 2) / (size * width))
        least = min(mpmath.sqrt(_dot(v, v)) for v in (p, q))
        far = o[7] + rows[k][7] + (chord + mpmath.mpf(1) / QUARTER) * least
        x, y = ([_dot(axis, v) for axis in axes_of(u)] for u, v in ((a, p), (b, q)))
        found = []
        for m in range(4 * QUARTER):
            angle = 2 * mpmath.atan(mpmath.mpf(m // 4) / QUARTER) + mpmath.pi / 2 * (m % 4)
            c, s = mpmath.cos(angle), mpmath.sin(angle)
            turned = c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]
            off = [g - h for g, h in zip(y, turned, strict=True)]
            found.append(mpmath.sqrt(_dot(off, off)) - far)
        return found


SIDES = slice(0, 3), slice(3, 6)


def near_rows(rng: np.random.Generator, n: int, bound: float) -> list[Row]:
    """Rows around a motion, most residuals larger than the bounds, and the first two within."""
    x = rng.uniform(-1.0, 1.0, (n, 3))
    R = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    R *= np.sign(np.linalg.det(R))
    bounds = bound * rng.uniform(0.3, 1.0, n)
    off = rng.standard_normal((n, 3))
    off *= (bounds * rng.uniform(0.3, 5.0, n) / np.linalg.norm(off, axis=1))[:, None]
    off[:2] /= np.maximum(1.0, np.linalg.norm(off[:2], axis=1) / bounds[:2])[:, None]
    y = x @ R.T + off
    return [row(*(p * ONE for p in pair)) for pair in zip(x, y, bounds, strict=True)]


def turn_cases() -> Iterator[Case]:
    """Random rows; then the bound of one at a turn where it just may be met, or just not."""
    rng = np.random.default_rng(11)
    for seed in range(8):
        rows = near_rows(rng, 5, 10.0 ** rng.uniform(-3.0, -0.7))
        off = {k: misses(rows, 0, 1, k) for k in (2, 3, 4)}
        sets = [sum((off[k][m] <= 0) << k for k in off) for m in range(4 * QUARTER)]
        ask = value_of(lambda checker, r=rows: checker.turned(r, 0, 1, 0b11100))
        yield Case(f"turns {seed}", ask, str(sets).replace("[", r"\[").replace("]", r"\]$"))
        for m in rng.choice(4 * QUARTER, 8, replace=False).tolist():
            reach = rows[2][7] + int(mpmath.nint(off[2][m]))
            for more, there in ((INSIDE, True), (-INSIDE, False)):
                if reach + more < 0:
                    continue  # the lengths may differ by more than the bounds of the others
                other = [*rows[:2], [*rows[2][:7], reach + more]]
                ask = value_of(lambda checker, r=other, m=m: checker.turned(r, 0, 1, 4)[m])
                yield Case(f"turn {m} of {seed}, {there}", ask, "4$" if there else "0$")


def near_cases() -> Iterator[Case]:
    """Rows e and f that are nearer to each other than their bounds, or along the axis of frames."""
    third = row((0, 9, 0), (0, 9, 0), 1)
    for b, good in (((4, 0, 0), False), ((4, 1, 0), True), ((0, 0, 0), False)):
        for bounds in ((2, 3), (3, 2)):  # 9 + 16 is not above 25, 9 + 17 is
            rows = [row((1, 1, 1), (0, 0, 0), bounds[0]), row((1, 1, 4), b, bounds[1]), third]
            answer = r"\[\d" if good else "REFUSED: rows 0 and 1 are too near to be turned about$"
            yield Case(f"near {b} {bounds}", asked(rows), answer)
    line = "REFUSED: two rows are along the axis of all frames$"
    for a, b, answer in (
        (AXIS, (55, 0, 0), line),
        ((55, 0, 0), [-k for k in AXIS], line),
        ((17, 29, 44), (55, 0, 0), r"\["),
        ((16, 29, 43), (55, 0, 0), r"\["),
        ((17, 30, 43), (55, 0, 0), r"\["),
    ):
        rows = [row((0, 0, 0), (0, 0, 0), 1), row(a, b, 1), third]
        yield Case(f"along {a} {b}", asked(rows), answer)


def asked(rows: list[Row]) -> Any:
    def ask(checker: Any) -> str:
        try:
            return repr(checker.turned(rows, 0, 1, (1 << len(rows)) - 4))
        except checker.RefusalError as error:
            return f"REFUSED: {error}"

    return ask


# --- Rows that one motion meets -------------------------------------------------------------------


def met_rows(rng: np.random.Generator, n: int, bits: int) -> list[Row]:
    """Rows that a motion meets, with residuals on their bounds, in integers."""
    w, *v = (int(k) for k in rng.integers(-4, 5, 4))
    norm = w * w + sum(k * k for k in v) or 1
    w = w if norm > 1 or any(v) else 1
    x = [[int(k) * norm for k in one] for one in rng.integers(-(1 << bits), 1 << bits, (n, 3))]
    rows = []
    for p in x:
        u = [c + w * k for c, k in zip(_cross(v, p), p, strict=True)]
        y = [k + 2 * c // norm for k, c in zip(p, _cross(v, u), strict=True)]
        off = [int(k) for k in rng.integers(-(1 << bits - 2), 1 << bits - 2, 3)]
        square = sum(k * k for k in off)
        bound = int(mpmath.ceil(mpmath.sqrt(square))) or 1
        rows.append(row(p, [k + d for k, d in zip(y, off, strict=True)], bound))
    return rows


def tilted(bound: int, length: int, far: int) -> list[Row]:
    """Rows e and f that are off across the line through them, and one that this tilts away."""
    return [
        row((0, 0, 0), (0, -bound, 0), bound),
        row((length, 0, 0), (length, bound, 0), bound),
        row((0, far, 0), (bound, far, 0), bound),
        row((0, 0, far), (0, 0, far + bound), bound),
        row((0, -far, 0), (-bound, -far, 0), bound),
    ]


def held(checker: Any, rows: list[Row]) -> bool:
    """Whether any two rows leave all others together at one turn at least."""
    every = (1 << len(rows)) - 1
    for e, f in permutations(range(len(rows)), 2):
        others = every & ~(1 << e) & ~(1 << f)
        try:
            if others not in checker.turned(rows, e, f, others):
                return False
        except checker.RefusalError:
            continue
    return True


def met_cases() -> Iterator[Case]:
    for bits in (5, 8, 64):  # of frames
        rng = np.random.default_rng(bits)
        clouds = [met_rows(rng, 5, int(rng.integers(4, 40))) for _ in range(30)]
        clouds += [tilted(1 << 20, k << 20, far << 20) for k in (3, 20, 100) for far in (9, 999)]

        def ask(checker: Any, bits: int = bits, clouds: list[list[Row]] = clouds) -> str:
            kept, checker.GRID = checker.GRID, bits
            try:
                return repr([k for k, rows in enumerate(clouds) if not held(checker, rows)])
            finally:
                checker.GRID = kept

        yield Case(f"met in frames of {bits} bits", ask, r"\[\]$")


# --- Steps ----------------------------------------------------------------------------------------


def thinned(
    near: list[int],
    K: int,
    steps: Any,
    rows: Any = None,
    *,
    rigid: bool = True,
    looks: int = MANY,
) -> Any:
    """Asks what is left, and which neighbours, or how the steps are refused."""
    n = len(near)

    def ask(checker: Any) -> str:
        table = rows or [[0] * 8] * n
        try:
            thin = checker.Thinning(table, [*near], (1 << n) - 1, K, [looks], rigid=rigid)
            return f"{thin.after(steps)} {thin.near}"
        except checker.RefusalError as error:
            return f"REFUSED: {error}"

    return ask


CYCLE = edge_graph(5, [(i, (i + 1) % 5) for i in range(5)])
HUB = edge_graph(7, [p for p in combinations(range(7), 2) if p not in {(1, 2), (3, 4), (5, 6)}])


def pair_cases() -> Iterator[Case]:
    """Two rows whose common neighbours take K - 3 colours: one more, and they stay."""
    near = "REFUSED: rows 0 and 1 are too near to be turned about$"
    yield Case("pair of a cycle", thinned(CYCLE, 3, [[[0, 1]]]), r"0 \[16, 4, 10, 20, 9\]$")
    yield Case("pair of a cycle, K = 2", thinned(CYCLE, 2, [[[0, 1]]]), near)
    cut = r"127 \[124, 120, 121, 103, 103, 31, 31\]$"
    yield Case("pair with the hub", thinned(HUB, 5, [[[0, 1]]]), cut)
    for looks, answer in ((14, cut), (13, "REFUSED: the stages take more than")):
        # all seven rows; four beside the two; no group; the two
        ask = thinned(HUB, 5, [[[0, 1]]], looks=looks)
        yield Case(f"pair with the hub, {looks} looks", ask, answer)
    yield Case("pair with the hub, turned", thinned(HUB, 5, [[[1, 0]]]), cut)
    yield Case("pair with the hub, K = 4", thinned(HUB, 4, [[[0, 1]]]), near)
    loose = thinned(HUB, 4, [[[0, 1]]], rigid=False)
    yield Case("pair, lengths not kept", loose, "REFUSED: row 0 with 1 is not struck$")
    apart = "REFUSED: row 0 with 1 is no neighbour$"
    yield Case("pair twice", thinned(HUB, 5, [[[0, 1]], [[0, 1]]]), apart)
    yield Case("pair twice, turned", thinned(HUB, 5, [[[1, 0]], [[0, 1]]]), apart)
    for pair, reason in (
        ([1, 2], "row 1 with 2 is no neighbour"),
        ([3, 3], "row 3 with 3 is no neighbour"),
        ([0], "a stage, a step or a group is not a list"),
        ([0, 1, 3], "a stage, a step or a group is not a list"),
        ([], "a stage, a step or a group is not a list"),
        ([0, 7], "a number of the stages is out of range"),
        ([-1, 0], "a number of the stages is out of range"),
        ([0, True], "a number of the stages is out of range"),
        ([0, [1]], "a number of the stages is out of range"),
        ({"0": 1}, "a number of the stages is out of range"),
    ):
        yield Case(f"pair {pair}", thinned(HUB, 5, [[pair]]), f"REFUSED: {reason}")
    gone = thinned(HUB, 6, [[0], [[3, 5]]])
    yield Case("pair of struck rows", gone, "REFUSED: a step strikes row 3 twice$")
    yield from grouped_cases()
    yield from mirrored_cases()


def grouped_cases() -> Iterator[Case]:
    """Groups that are refuted with both rows: 2 + |U| - h + colours < K."""
    line = [row((0, 0, 0), (0, 30, 0), 10)]
    line += [row((k, 0, 0), (k, 0, 0), 10) for k in (-900, 900, -800, 800, -700)]
    one, two = [[2], [2, 1, 1]], [[4], [2, 0, 1]]
    refuted = "REFUSED: a group of row 0 with 1 is not refuted$"
    good = r"\d+ \[6[0124], 6[01], "
    stays = "REFUSED: row 0 with 1 is not struck$"
    for name, groups, K, answer in (
        ("one", [one], 6, good),
        ("one, less", [one], 5, stays),
        ("no weight of the first", [[[2], [0, 2, 1]]], 6, refuted),
        ("of one side", [two], 6, refuted),
        ("weights too few", [[[2], [2, 1]]], 6, "REFUSED: a group of row 0 with 1 is not weighed$"),
        ("weights too many", [[[2], [2, 1, 1, 1]]], 6, "REFUSED: a group of row 0 with 1 is not w"),
        ("of the row itself", [[[1], [2, 1, 1]]], 6, "REFUSED: a group of row 0 with 1 is not of"),
    ):
        ask = thinned(complete(6), K, [[[0, 1], *groups]], line)
        yield Case(f"pair with groups, {name}", ask, answer)
    wide = [[*one[:7], 14] for one in line]  # weights 2, 1, 1 refute up to 15, 1, 2, 1 to 12.8
    for pair, answer in (([0, 1], good), ([1, 0], refuted.replace("0 with 1", "1 with 0"))):
        ask = thinned(complete(6), 6, [[pair, one]], wide)
        yield Case(f"weights in the order of {pair}", ask, answer)
    alone = edge_graph(6, [p for p in combinations(range(6), 2) if p != (1, 2)])
    ask = thinned(alone, 4, [[[0, 1], one]], line)
    yield Case("a group of one row's neighbours", ask, "REFUSED: a group of row 0 with 1 is not of")


def mirrored(bound: int, other: int = 10) -> list[Row]:
    """0, e3, e1 and e2, of which the last is mirrored: all lengths agree."""
    points = [(0, 0, 0), (0, 0, 10), (10, 0, 0), (0, other, 0)]
    return [row(p, p, bound) for p in points[:3]] + [row(points[3], (0, -other, 0), bound)]


def mirrored_cases() -> Iterator[Case]:
    """Two rows each of which needs a turn of its own about the first two: one at a turn."""
    struck, stays = r"0 \[12, 12, 11, 7\]$", "REFUSED: row 0 with 1 is not struck$"
    step = [[[0, 1]]]
    yield Case("mirrored", thinned(complete(4), 4, step, mirrored(1)), struck)
    yield Case("mirrored, K = 3", thinned(complete(4), 3, step, mirrored(1)), stays)
    yield Case("mirrored, wide", thinned(complete(4), 4, step, mirrored(4)), stays)
    both = [*mirrored(1), row((0, 10, 1), (0, -10, 1), 1)]  # two go together, at one turn
    yield Case("two mirrored", thinned(complete(5), 4, step, both), stays)
    yield Case("two mirrored, K = 5", thinned(complete(5), 5, step, both), r"0 \[28, 28, ")
    apart = edge_graph(5, [p for p in combinations(range(5), 2) if p != (3, 4)])
    yield Case("two mirrored, apart", thinned(apart, 4, step, both), r"\d+ \[28, 28, ")
    # All rows; two beside, coloured, then turned; a row of two sets; two with one less; two more
    least = 4 + 2 + 128 + 2 + 2 + 2
    for looks, answer in ((least, r"0 \["), (least - 1, "REFUSED: the stages take more than ")):
        ask = thinned(complete(4), 4, step, mirrored(1), looks=looks)
        yield Case(f"mirrored, {looks} looks", ask, answer)


def turning_cases() -> Iterator[Case]:
    for part in (pair_cases, near_cases, turn_cases, met_cases):
        yield from part()
