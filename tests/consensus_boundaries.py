"""What the checker must say of wrong pairs just inside and just outside of its inequalities.

Cases as those of `checker_boundaries`, and all vectors of the kind. What is right is found here by
exact fractions from the definitions, or is plain from the example; graphs are stated by their
edges, so that rules about them are asked without any geometry.
"""

from __future__ import annotations

import copy
import json
import random
import struct
from base64 import b64decode
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import certificates as oracle
import numpy as np
from checker_boundaries import NEAR, Case, dyadic, outcome_of, value_of
from turning_boundaries import turning_cases

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

Document = dict[str, Any]
VECTORS = Path(__file__).parent.parent / "vectors"
PREFIX = b"certreg-consensus/1\0"
MANY = 10**9  # looks
STRUCK = "REFUSED: row 0 is not struck$"


@dataclass(frozen=True)
class Stated:
    """Rows of numbers, a witness that is the identity unless told, and no stages."""

    source: Any
    target: Any
    bounds: Any
    weights: Any = None
    quaternion: tuple[int, ...] = (1, 0, 0, 0)
    shift: tuple[int, ...] = (0, 0, 0, 0)

    @property
    def content(self) -> bytes:
        n = len(self.source)
        weights = [1.0] * n if self.weights is None else self.weights
        numbers = [*np.ravel(self.source), *np.ravel(self.target), *weights, *self.bounds]
        return PREFIX + struct.pack(f"<Q{8 * n}d", n, *(float(k) + 0.0 for k in numbers))

    def document(self, labels: str, upper: int, stages: Any = (), **parts: Any) -> Document:
        return {
            "about": {},
            "claims": {"labels": labels, "upper": upper},
            "fit": None,
            "format": "certreg-certificate/1",
            "kind": "consensus",
            "problem": oracle.stated_problem(self.content, len(self.source)),
            "stages": list(stages),
            "witness": {"quaternion": [*self.quaternion], "shift": [*self.shift]},
            **parts,
        }


@cache
def vector(name: str) -> str:
    return (VECTORS / f"{name}.json").read_text("utf-8")


def document_of(name: str = "accept-consensus") -> Document:
    return json.loads(vector(name))


def vector_cases() -> Iterator[Case]:
    for path in sorted(VECTORS.glob("*-consensus*.json")):
        answer = "VERIFIED" if path.name.startswith("accept") else "REFUSED"
        yield Case(path.stem, outcome_of(path.read_bytes()), answer)


# --- Lengths --------------------------------------------------------------------------------------

FINE = 1 << 40


def row(x: Iterable[int], y: Iterable[int], bound: int = 1, weight: int = 1) -> list[int]:
    return [*x, *y, weight, bound]


def length_cases() -> Iterator[Case]:
    """Two rows with lengths a, b and the sum d of their bounds: neighbours iff |a - b| <= d."""
    lengths = {
        "3 and 7": ((1, 2, 2), (2, 3, 6), 4),
        "7 and 3": ((-6, 2, 3), (2, -2, 1), 4),
        "9 and 11": ((4, -4, 7), (6, 9, 2), 2),
        "0 and 7": ((0, 0, 0), (6, 2, -3), 7),
        "7 and 0": ((-2, 6, 3), (0, 0, 0), 7),
        "5 and 5": ((0, 3, 4), (-5, 0, 0), 0),
    }
    for name, (x, y, apart) in lengths.items():
        for at, off in (((5, -1, 2), (-3, 4, 9)), ((0, 0, 0), (0, 0, 0))):
            first = [FINE * k for k in at], [FINE * k for k in off]
            second = (
                [FINE * (k + p) for k, p in zip(at, x, strict=True)],
                [FINE * (k + p) for k, p in zip(off, y, strict=True)],
            )
            for more, near in ((0, True), (-1, False), (1, True), (FINE * 99, True)):
                d = FINE * apart + more
                if d >= 0:
                    rows = [row(*first, d // 3), row(*second, d - d // 3)]
                    answer = r"\[2, 1\]$" if near else r"\[0, 0\]$"
                    ask = value_of(lambda checker, r=rows: checker.consistent(r))
                    yield Case(f"lengths {name}, {more} from {at}", ask, answer)
    wide = [row((0, 0, 0), (0, 0, 0), 2), row((3, 0, 0), (0, 4, 0), 3), row((9, 0, 0), (0, 0, 0))]
    yield Case("D = 0", value_of(lambda checker: checker.consistent(wide)), r"\[2, 5, 2\]$")


# --- The witness ----------------------------------------------------------------------------------


def witness_cases() -> Iterator[Case]:
    """Three pairs that are met, one of them at its bound exactly."""
    points = np.array([[30.0, 0, 0], [0, 30, 0], [0, 0, 30]])
    q, norm = (1, 2, 3, 4), 30
    R = np.array(
        [[-20, 4, 22], [20, -10, 20], [10, 28, 4]]
    )  # 30 R(q), by hand: w^2 + x^2 - y^2 - z^2 = -20
    few = "REFUSED: the witness meets 2 pairs: 3 needed$"
    for unit in (2.0**-60, 1.0, 2.0**60):
        for e in (-3, 0, 70):
            t = np.array([3.0, -5, 7]) * 2.0**e / unit
            if np.abs(t).max() > 2.0**80:
                continue
            moved = points @ R.T / norm + t
            for k, off in enumerate(([0.375, -0.5, 0], [0, 0.375, 0.5], [-0.5, 0, 0.375])):
                target = moved.copy()
                target[k] += np.array(off)
                if np.any((target - moved)[k] != off):
                    continue
                for bound, answer in ((0.625, "VERIFIED"), (0.625 - 2.0**-50, few)):
                    bounds = np.array([2.0**-20] * 3)
                    bounds[k] = bound
                    shift = (3, -5, 7, e)
                    stated = Stated(points * unit, target * unit, bounds * unit, None, q, shift)
                    document = stated.document("iii", 3)
                    yield Case(f"witness {unit} {e} {k} {bound}", outcome_of(document), answer)
                    longer = Stated(
                        points * unit, target * unit, bounds * unit, None, (-3, -6, -9, -12), shift
                    )
                    longer_document = longer.document("iii", 3)
                    yield Case(f"longer {unit} {e} {k}", outcome_of(longer_document), answer)
    plain = Stated(points, points, [1.0] * 3)
    for e, answer in (
        (32768, "VERIFIED"),
        (-32768, "VERIFIED"),
        (32769, ".*motion"),
        (-32769, "."),
    ):
        found = plain.document(
            "iii", 3, witness={"quaternion": [1, 0, 0, 0], "shift": [0, 0, 0, e]}
        )
        yield Case(f"exponent {e}", outcome_of(found), answer if "V" in answer else "REFUSED: w")
    still = {"quaternion": [0, 0, 0, 0], "shift": [0, 0, 0, 0]}
    zero = plain.document("iii", 3, witness=still)
    yield Case("no quaternion, no shift", outcome_of(zero), "REFUSED: witness is no motion$")
    for q in ([1, 0, 0, 0], [3, 0, 0, 0]):
        for bound, answer in ((1.0, "VERIFIED"), (1.0 - 2.0**-50, few)):
            target = points + np.array([1.0, -2, 3])
            target[1] += [0.6875, 0.5, 0.0]
            target[2] -= [1.0, 0.0, 0.0]
            fine = {"quaternion": q, "shift": [1 << 300, -1 << 301, 3 << 300, -300]}
            stated = Stated(points, target, [1.0, 1.0, bound])
            finer = stated.document("iii", 3, witness=fine)
            yield Case(f"a finer shift {q} {bound}", outcome_of(finer), answer)
    yield from data_cases(points)


def data_cases(points: Any) -> Iterator[Case]:
    """Bounds and weights of three pairs."""
    for place, value in (("bounds", 0.0), ("bounds", -1.0), ("weights", -1.0)):
        parts = {"bounds": [1.0] * 3, "weights": [1.0] * 3}
        parts[place][1] = value
        spoilt = Stated(points, points, parts["bounds"], parts["weights"]).document("iii", 3)
        yield Case(f"{place} {value}", outcome_of(spoilt), "REFUSED: row 1 has a bound <= 0 or")
    light = Stated(points, points, [5e-324] * 3, [0.0, 0.0, 0.0])
    yield Case("sizes", outcome_of(light.document("iii", 3)), "REFUSED: the data hold numbers of")
    none = Stated(points, points, [1.0] * 3, [0.0] * 3).document("iii", 3)
    yield Case("no weights, no fit", outcome_of(none), "VERIFIED")


# --- Graphs ---------------------------------------------------------------------------------------


def graph(n: int, edges: Iterable[tuple[int, int]]) -> list[int]:
    near = [0] * n
    for i, j in edges:
        near[i] |= 1 << j
        near[j] |= 1 << i
    return near


def left(
    near: list[int],
    K: int,
    steps: Any = (),
    rows: Any = None,
    alive: int = -1,
    looks: int = MANY,
) -> Any:
    """Asks what is left of all rows, or how they are refused."""
    n = len(near)

    def ask(checker: Any) -> str:
        try:
            thin = checker.Thinning(rows or [[0] * 8] * n, near, alive & ((1 << n) - 1), K, [looks])
            return repr(thin.after(list(steps)))
        except checker.RefusalError as error:
            return f"REFUSED: {error}"

    return ask


CYCLE = graph(5, [(i, (i + 1) % 5) for i in range(5)])
PATH = graph(5, [(i, i + 1) for i in range(4)])
OCTAHEDRON = graph(7, [p for p in combinations(range(7), 2) if p not in {(1, 2), (3, 4), (5, 6)}])
CROWN = graph(
    9,
    [(0, k) for k in range(1, 9)]
    + [
        (i, j)
        for i, j in combinations(range(1, 9), 2)
        if (i + j) % 2 and (j != i + 1 or i % 2 == 0)
    ],
)  # rows 1, 3, 5, 7 and 2, 4, 6, 8: each next to all of the other kind but its partner


def graph_cases() -> Iterator[Case]:
    """K - 1 neighbours, K - 2 colours: one more, and the row falls."""
    for K, answer in ((2, 31), (3, 31), (4, 0)):
        yield Case(f"cycle {K}", left(CYCLE, K), f"{answer}$")
    for K, answer in ((1, 31), (2, 31), (3, 0)):
        yield Case(f"path {K}", left(PATH, K), f"{answer}$")
    paths = graph(6, [(0, 1), (1, 2), (3, 4), (4, 5)])
    yield Case("two paths, from all ends at once", left(paths, 3), "0$")
    yield Case("part of a cycle", left(CYCLE, 3, alive=15), "0$")
    yield Case("nothing struck", left(CYCLE, 2, alive=15), "15$")
    for K, answer in ((4, STRUCK), (5, "126$"), (6, "0$")):
        yield Case(f"octahedron {K}", left(OCTAHEDRON, K, [[0]]), answer)
    for K, answer in ((3, STRUCK), (4, r"\d+$"), (5, r"\d+$")):  # four colours, cliques of two
        thick = [near | 0b111 << 9 for near in CROWN]
        more = [(1 << 12) - 1 & ~(1 << i) for i in (9, 10, 11)]
        yield Case(f"crown {K + 3}", left([*thick, *more], K + 3, [[0]]), answer)
    for most in range(7):
        counted = min(4, most + 1)
        ask = value_of(lambda checker, m=most: checker.colours(0b111111110, CROWN, m))
        yield Case(f"colours at most {most}", ask, f"{counted}$")
    for looks, answer in ((20, "126$"), (19, "REFUSED: the stages take more than")):
        # all seven rows; six neighbours, coloured; no group; six with one less
        ask = left(OCTAHEDRON, 5, [[0]], looks=looks)
        yield Case(f"octahedron, {looks} looks", ask, answer)
    for looks, answer in ((8, "0$"), (7, "REFUSED: the stages take more than")):
        # five rows, two ends fall; two beside, they fall; the middle, which falls
        yield Case(f"path, {looks} looks", left(PATH, 3, looks=looks), answer)
    none = value_of(lambda checker: (checker.colours(0, CROWN, 0), checker.colours(2, CROWN, 0)))
    yield Case("colours of none", none, r"\(0, 1\)$")
    ninth = [near | 1 << 7 for near in OCTAHEDRON]
    without = left([*ninth, 127], 5, [[0]], alive=127)
    yield Case("a neighbour that is not left", without, "126$")
    twice = "REFUSED: a step strikes row 0 twice$"
    yield Case("twice", left(OCTAHEDRON, 5, [[0], [0]]), twice)
    gone = left(OCTAHEDRON, 5, [[0]], alive=126)
    yield Case("a row that is not there", gone, twice)
    yield Case("all at once", left(graph(3, []), 2), "0$")
    for steps, reason in (
        ([0], "a stage, a step or a group is not a list"),
        ([[]], "a number of the stages is out of range"),
        ([[7]], "a number of the stages is out of range"),
        ([[True]], "a number of the stages is out of range"),
        ([[0.0]], "a number of the stages is out of range"),
        ([[0, 1]], "a stage, a step or a group is not a list"),
        ([[0, [[1], [1, 1], []]]], "a stage, a step or a group is not a list"),
        ([[0, [1, [1, 1]]]], "a stage, a step or a group is not a list"),
        ([[0, [[7], [1, 1]]]], "a number of the stages is out of range"),
        ([[0, [[1 << 300], [1, 1]]]], "a number of the stages is out of range"),
        ([[0, [[1], [1, -1]]]], "a number of the stages is out of range"),
        ([[0, [[1], [1, (1 << 256) + 1]]]], "a number of the stages is out of range"),
        ([[0, [[1], [1, 1 << 256]]]], "a group of row 0 is not refuted"),
        ([[0, [[1], [1]]]], "a group of row 0 is not weighed"),
        ([[0, [[1], [0, 0]]]], "a group of row 0 is not weighed"),
        ([[0, [[], [1]]]], "a group of row 0 is not of its neighbours"),
        ([[0, [[0], [1, 1]]]], "a group of row 0 is not of its neighbours"),
        ([[0, [[1, 1], [1, 1, 1]]]], "a group of row 0 is not of its neighbours"),
        ([[1, [[2], [1, 1]]]], "a group of row 1 is not of its neighbours"),
    ):
        yield Case(f"steps {steps}", left(OCTAHEDRON, 4, steps), f"REFUSED: {reason}")


# --- Groups ---------------------------------------------------------------------------------------


def complete(n: int) -> list[int]:
    return graph(n, combinations(range(n), 2))


def group_cases() -> Iterator[Case]:
    """A middle that is lifted by v: with weights 2, 1, 1 the least of sum w r^2 is v^2."""
    refuted = "REFUSED: a group of row 0 is not refuted$"
    for bound, v, good in ((5, 10, False), (5, 11, True), (5, 9, False), (1 << 90, 1 << 91, False)):
        for turned in range(3):
            places = [(0, 0, 0), (-40 * bound, 0, 0), (40 * bound, 0, 0)]
            ups = [(0, v, 0), places[1], places[2]]
            rows = [
                row(roll(x, turned, 7), roll(y, turned + 1, -9), bound)
                for x, y in zip(places, ups, strict=True)
            ]
            answer = "0$" if good else refuted
            step = [[0, [[1, 2], [2, 1, 1]]]]
            yield Case(f"lifted {bound} {v} {turned}", left(complete(3), 3, step, rows), answer)
    line = [row((0, 0, 0), (0, 30, 0), 10)]
    line += [row((k, 0, 0), (k, 0, 0), 10) for k in (-900, 900, -800, 800)]
    one, two = [[1, 2], [2, 1, 1]], [[3, 4], [2, 1, 1]]
    struck = "30$|0$"
    for name, groups, K, answer in (
        ("two groups", [one, two], 4, struck),
        ("two groups, one less", [one, two], 3, STRUCK),
        ("one group and two colours", [one], 5, struck),
        ("one group and two colours, one less", [one], 4, STRUCK),
        ("no group", [], 5, STRUCK),
        ("a row in two groups", [one, [[2, 3], [2, 1, 1]]], 5, struck),
        ("a row in two groups, one less", [one, [[2, 3], [2, 1, 1]]], 4, STRUCK),
        ("a group twice", [one, one], 5, struck),
        ("a group twice, one less", [one, one], 4, STRUCK),
    ):
        yield Case(name, left(complete(5), K, [[0, *groups]], line), answer)
    apart = graph(5, set(combinations(range(5), 2)) - {(1, 2)})
    yield Case("rows of a group have no colour", left(apart, 3, [[0, one, two]], line), STRUCK)
    gone = [[0, one, two], [1, [[0], [1, 1]]]]
    yield Case(
        "a group of a struck row", left(complete(5), 4, gone, line), "REFUSED: a group of row 1"
    )
    yield from weight_cases(refuted)
    yield from hit_cases()
    yield from clique_cases()


def hit_cases() -> Iterator[Case]:
    """How many rows hold one of each set: against all subsets, of random sets of six rows."""
    rng = random.Random(5)
    families = [
        [rng.randrange(1, 64) & rng.randrange(1, 64) or 1 for _ in range(rng.randrange(7))]
        for _ in range(60)
    ]

    def hit(checker: Any) -> bool:
        for sets in families:
            least = min(rows.bit_count() for rows in range(64) if all(rows & mask for mask in sets))
            thin = checker.Thinning([[0] * 8] * 6, complete(6), 63, 3, [10**4])
            found = [thin._hit(sets, most) for most in range(-2, 7)]
            if found != [most >= least for most in range(-2, 7)]:
                return False
        return True

    yield Case("rows that hold one of each set", value_of(hit), "True$")

    def costly(checker: Any) -> str:
        sets = [1 << i | 1 << j for i, j in combinations(range(14), 2)]  # 13 rows are needed
        thin = checker.Thinning([[0] * 8] * 14, [], 0, 3, [10**3])
        try:
            thin._hit(sets, 12)
        except checker.RefusalError:
            return "REFUSED"
        return "found"

    yield Case("a search without end", costly, "REFUSED$")


def clique_cases() -> Iterator[Case]:
    """Cliques that hold none of some sets: against all subsets, of random graphs of seven rows."""
    rng = random.Random(6)
    every = [*combinations(range(7), 2)]
    asked = [
        (
            graph(7, rng.sample(every, rng.randrange(8, 22))),
            rng.randrange(1, 128) | rng.randrange(1, 128),
            [
                sum(1 << i for i in rng.sample(range(7), k))
                for k in rng.choices((1, 2, 2, 3, 4), k=m)
            ],
        )
        for m in (0, 1, 2, 3, 4, 5, 6) * 12
    ]

    def largest(near: list[int], rows: int, sets: list[int]) -> int:
        return max(
            mask.bit_count()
            for mask in range(128)
            if mask & ~rows == 0
            and all(mask & ~(near[i] | 1 << i) == 0 for i in range(7) if mask >> i & 1)
            and not any(mask & T == T for T in sets)
        )

    def searched(checker: Any) -> list[int]:
        return [
            k
            for k, (near, rows, sets) in enumerate(asked)
            if [checker.has_clique(near, rows, sets, m, lambda _: None) for m in range(9)]
            != [m <= largest(near, rows, sets) for m in range(9)]
        ]

    yield Case("cliques that hold none of some sets", value_of(searched), r"\[\]$")
    looks = list[int]()

    def costs(checker: Any) -> int:
        looks.clear()
        checker.has_clique(complete(4), 15, [3, 12], 2, looks.append)
        return sum(looks)

    # each time the two sets; and four rows; with row 0 the rows 2 and 3; with row 2, none
    yield Case("what a search for cliques costs", value_of(costs), "15$")
    step = [[0, [[1, 2], [1, 1, 1]], [[1, 3], [1, 1, 1]], [[2, 3], [1, 1, 1]]]]
    spread = [row((0, 0, 0), (0, 0, 0)), *[row(p, p) for p in ((9, 0, 0), (0, 9, 0), (0, 0, 9))]]
    unmet = left(complete(4), 3, step, spread)
    yield Case("groups that are met", unmet, "REFUSED: a group of row 0 is not refuted")
    yield from searched_cases()


def searched_cases() -> Iterator[Case]:
    """A lifted row with groups that need only one row each, but two colours apart."""
    line = [row((0, 0, 0), (0, 30, 0), 10)]
    line += [row((k, 0, 0), (k, 0, 0), 10) for k in (-900, 900, -800, 800)]
    groups = [[list(T), [2, 1, 1]] for T in ((1, 2), (3, 4), (1, 4), (2, 3))]
    ring = graph(5, [*((0, k) for k in range(1, 5)), (1, 2), (2, 3), (3, 4), (4, 1)])
    for name, some, K, answer in (
        ("all edges of a ring", groups, 3, r"\d+$"),
        ("all but one", groups[:3], 3, STRUCK),
        ("one row beside", groups, 2, STRUCK),
    ):
        yield Case(f"groups, {name}", left(ring, K, [[0, *some]], line), answer)


def roll(point: tuple[int, int, int], by: int, off: int) -> list[int]:
    """The coordinates in another order, away from the origin."""
    return [point[(k - by) % 3] + off * (k + 1) for k in range(3)]


def weight_cases(refuted: str) -> Iterator[Case]:
    """Random rows, weights and bounds, of a size at 1 -+ 1e-9 of where they refute."""
    rng = np.random.default_rng(4)
    for seed, count in enumerate((2, 3, 5, 8)):
        x, y = (rng.integers(-(2**30), 2**30, (count, 3)).tolist() for _ in range(2))
        L = rng.integers(0 if seed else 1, 50, count).tolist()
        L[0] += 1
        share = rng.uniform(0.5, 2.0, count)
        cost = least_cost(x, y, L)
        total = float(sum(w * float(b) ** 2 for w, b in zip(L, share, strict=True)))
        size = (cost / total) ** 0.5
        for factor, good in ((1 - float(NEAR), True), (1 + float(NEAR), False)):
            one = 2**60
            bounds = [round(float(b) * size * factor * one) for b in share]
            rows = [
                [one * k for k in (*p, *q)] + [1, b] for p, q, b in zip(x, y, bounds, strict=True)
            ]
            step = [[0, [list(range(1, count)), L]]]
            answer = "0$" if good else refuted
            yield Case(
                f"weights {count} {factor}", left(complete(count), count, step, rows), answer
            )


def least_cost(x: Any, y: Any, w: Any) -> float:
    """The least sum w r^2, by the definitions; its eigenvalue in doubles."""
    mass, C, S = oracle.exact_moments(x, y, w)
    _, _, T = oracle.exact_moments(y, x, w)
    K = np.array(oracle.rotation_form(C), dtype=float)
    del mass
    spread = float(sum(A[k][k] for A in (S, T) for k in range(3)))
    return spread - 2.0 * float(np.linalg.eigvalsh(K)[-1])


# --- Stages, claims, sizes ------------------------------------------------------------------------


def changed_document(name: str, **parts: Any) -> Document:
    found = copy.deepcopy(document_of(name))
    found["claims"].update({k: parts.pop(k) for k in ("labels", "upper") if k in parts})
    return found | parts


def stage_cases() -> Iterator[Case]:
    """Eight rows, six of them met, one undecided: K = 6."""
    name = "accept-consensus-undecided"
    one, two, *others = document_of(name)["stages"]
    misplaced = "REFUSED: a stage is misplaced$"
    first = "REFUSED: the first stage leaves a pair out$"
    for said, stages, answer in (
        ("in another order", [one, *others, two], "VERIFIED"),
        ("with one more twice", [one, two, two, *others], "VERIFIED"),
        ("with two more", [one, two, [8, 8, []], [9, 8, []], *others], "VERIFIED"),
        ("with three more", [one, two, [10, 8, []], *others], "REFUSED: a number of the stages"),
        ("with the first twice", [one, one, two, *others], "VERIFIED"),
        ("going back", [one, two, one, *others], misplaced),
        ("one that leaves out first", [others[0], one, two, *others], first),
        ("the second first", [two, one, *others], misplaced),
        ("one that leaves out twice", [one, two, *others, others[-1]], "VERIFIED"),
        ("one that leaves out of all", [one, two, *others, [7, 1, []]], misplaced),
        ("one that leaves an outlier out", [one, two, *others, [6, 7, []]], "VERIFIED"),
        ("one that leaves none out late", [one, *others, [6, 8, []], two], "VERIFIED"),
    ):
        document = changed_document(name, stages=stages)
        yield Case(f"stages {said}", outcome_of(document), answer)
    number = "REFUSED: a number of the stages is out of range$"
    for stage, answer in (
        ([6, 9, []], number),
        ([6, -1, []], number),
        ([6, False, []], number),
        ([7, 8, []], misplaced),
        ([5, 8, []], misplaced),
    ):
        alone = changed_document(name, stages=[stage], labels="????????", upper=8)
        yield Case(f"the stage {stage} alone", outcome_of(alone), answer)
    late = changed_document(name, stages=[one, two, *others, [6, 0, []]], labels="iiiiii?o")
    undecided = "REFUSED: claims.labels: that of row 0 is not proved$"
    yield Case("as many are left without row 0", outcome_of(late), undecided)
    for row_left in range(1, 6):
        kept = [stage for stage in others if stage[1] != row_left]
        document = changed_document(name, stages=[one, two, *kept])
        answer = f"REFUSED: claims.labels: that of row {row_left} is not proved$"
        yield Case(f"stage without row {row_left} missing", outcome_of(document), answer)
    for upper, answer in (
        (5, "REFUSED: claims.upper is below the proved bound 6$"),
        (7, "VERIFIED"),
    ):
        yield Case(f"upper {upper}", outcome_of(changed_document(name, upper=upper)), answer)
    loose = changed_document(name, stages=[one], labels="???????o", upper=7)
    yield Case("upper of the rows left", outcome_of(loose), "VERIFIED")
    less = changed_document(name, stages=[one], labels="???????o", upper=6)
    yield Case("upper below the rows left", outcome_of(less), "REFUSED: claims.upper")
    bare = changed_document(name, stages=[], labels="????????", upper=8)
    yield Case("upper of all", outcome_of(bare), "VERIFIED")
    for labels in ("i???????", "???????o"):
        spoilt = changed_document(name, stages=[], labels=labels, upper=8)
        yield Case(f"no stage, {labels}", outcome_of(spoilt), "REFUSED: claims.labels")
    true = "?iiiii?o"
    for k, letter in enumerate(true):
        for other in "io?x":
            labels = true[:k] + other + true[k + 1 :]
            good = other in (letter, "?")
            answer = (
                "VERIFIED" if good else f"REFUSED: claims.labels: that of row {k} is not proved$"
            )
            yield Case(
                f"labels {labels}", outcome_of(changed_document(name, labels=labels)), answer
            )
    yield from later_cases()
    yield from plate_cases()
    yield from parted_cases()


def later_cases() -> Iterator[Case]:
    """Strikes of a stage that asks for more tell nothing of labels, but of the upper bound."""
    points = [[0.0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8], [0, 0, 0]]
    target = [*points[:4], [0.625, 0.625, 0.625]]
    pairs = Stated(points, target, [0.5] * 5)
    for labels, answer in (
        ("?????", "VERIFIED"),
        ("????o", "REFUSED: claims.labels: that of row 4"),
    ):
        document = pairs.document(labels, 4, [[4, 5, []], [5, 5, []]])
        yield Case(f"later strikes {labels}", outcome_of(document), answer)
    kept = pairs.document("?iii?", 4, [[4, 5, []], [5, 5, []], *[[4, i, []] for i in (1, 2, 3)]])
    yield Case("left out of the first stage's rows", outcome_of(kept), "VERIFIED")


def plate_cases() -> Iterator[Case]:
    """A plate with a point that is mirrored, and a row of it with two targets: K = 6."""
    source = [[4.0, 0, 0], [-4, 3, 0], [-4, -3, 0], [-5, 0, 0], [5, 3, 0], [5, -4, 0]]
    target = [*source, [0, 0, -2], [4, 0, -1.5]]
    pairs = Stated([*source, [0, 0, 2], source[0]], target, [0.5] * 8)
    loose = {(0, 4, 5), (1, 2, 3)}  # which are met with the mirrored point
    threes = [T for T in combinations(range(6), 3) if T not in loose]
    step = [6, *[[list(T), [1, 1, 1, 1]] for T in threes]]
    for stages, upper, answer in (
        ([[6, 8, [step]], [7, 8, []]], 6, "VERIFIED"),
        ([[6, 8, []], [6, 8, [step]], [7, 8, []]], 6, "VERIFIED"),
        ([[6, 8, [step]]], 7, "VERIFIED"),
        ([[6, 8, [step]]], 6, "REFUSED: claims.upper is below the proved bound 7$"),
        ([[6, 8, [step[:-1]]]], 7, "VERIFIED"),
        ([[6, 8, [step[:3]]]], 7, "REFUSED: row 6 is not struck$"),
        ([[6, 8, []], [7, 8, []]], 7, "REFUSED: claims.upper is below the proved bound 8$"),
    ):
        found = pairs.document("????????", upper, stages)
        yield Case(f"plate {len(str(stages))} {upper}", outcome_of(found), answer)


def parted_cases() -> Iterator[Case]:
    """Rows that are struck together by turns: a plate, and a point that is mirrored; K = 6.

    Strikes of the first stage stand in all, those of another one there alone.
    """
    plate = [[4.0, 0, 0], [-4, 3, 0], [-4, -3, 0], [-5, 0, 0], [5, 3, 0], [5, -4, 0]]
    pairs = Stated([*plate, [0, 0, 2]], [*plate, [0, 0, -2]], [0.5] * 7)
    part: Any = [[6, 0]]
    for stages, labels, upper, answer in (
        ([[6, 7, [part, [[1, 6]]]]], "iiiiiio", 6, "VERIFIED"),
        ([[6, 7, [part]]], "iiiiiio", 7, "REFUSED: claims.labels: that of row 0 is not proved$"),
        ([[6, 7, [part]]], "???????", 7, "VERIFIED"),
        ([[6, 7, [part]]], "???????", 6, "REFUSED: claims.upper"),
        ([[6, 7, [part]], [7, 7, []]], "???????", 6, "VERIFIED"),
        ([[6, 7, [part]], [6, 1, []]], "?i?????", 7, "VERIFIED"),
        ([[6, 7, [part]], [6, 0, []]], "i??????", 7, "REFUSED: claims.labels: that of row 0"),
        ([[6, 7, []], [6, 0, [[[6, 1]]]], [6, 2, []]], "i??????", 7, "VERIFIED"),
        ([[6, 7, []], [6, 0, [[[6, 1]]]], [6, 2, []]], "i?i????", 7, "REFUSED: claims.labels: th"),
        ([[6, 7, []], [7, 7, [part]], [6, 1, []]], "???????", 6, "VERIFIED"),
        ([[6, 7, []], [7, 7, [part]], [6, 1, []]], "?i?????", 6, "REFUSED: claims.labels: that"),
        ([[6, 7, [[[0, 1]]]]], "???????", 7, "REFUSED: row 0 with 1 is not struck$"),
    ):
        found = pairs.document(labels, upper, stages)
        yield Case(f"parted {stages} {labels} {upper}", outcome_of(found), answer)


def size_cases() -> Iterator[Case]:
    """How many pairs, looks, and pairs that are met."""
    good = json.dumps(document_of()).encode()
    for limits, answer in (
        ({"ROWS_MAX": 12}, "VERIFIED"),
        ({"ROWS_MAX": 11}, "REFUSED: more than 11 pairs$"),
        ({"ROWS_BITS": 12 * BITS}, "VERIFIED"),
        (
            {"ROWS_BITS": 12 * BITS - 1},
            "REFUSED: the data hold numbers of too many sizes for 12 pairs$",
        ),
        ({"LEAST": 6}, "VERIFIED"),
        ({"LEAST": 7}, "REFUSED: the witness meets 6 pairs: 7 needed$"),
        ({"LOOKS_MAX": LOOKS}, "VERIFIED"),
        ({"LOOKS_MAX": LOOKS - 1}, f"REFUSED: the stages take more than {LOOKS - 1} looks$"),
    ):
        yield Case(f"sizes {limits}", outcome_of(good, **limits), answer)
    limits = value_of(lambda checker: (checker.ROWS_MAX, checker.LEAST, checker.LOOKS_MAX))
    yield Case("limits", limits, r"\(4096, 3, 16777216\)$")
    bits = value_of(lambda checker: checker.ROWS_BITS)
    yield Case("limit of numbers", bits, "1048576$")
    for least, most in ((-9, 5), (-5, 9)):  # 9 over 2^-55: 59 bits, times three rows
        points = [[0.0, 0, 0], [most, 0, 0], [0, least, 0]]
        few = Stated(points, points, [0.125] * 3).document("iii", 3)
        for allowed, answer in (
            (177, "VERIFIED"),
            (176, "REFUSED: the data hold numbers of too m"),
        ):
            ask = outcome_of(few, ROWS_BITS=allowed)
            yield Case(f"numbers from {least} to {most}, {allowed} bits", ask, answer)
    deep = document_of() | {"fit": {"kind": "isotropic", "x": 0}}
    text = json.dumps(deep)

    def answers(checker: Any) -> str:
        depths = [text.replace('"x": 0', f'"x": {"[" * k}{"]" * k}') for k in range(800, 1000)]
        return repr({checker.check(each.encode()).verified for each in depths})

    yield Case("a fit of any depth", answers, r"\{False\}$")


LOOKS = 67  # of the first vector: twelve rows, then those that lose a neighbour, and four steps
BITS = 56  # of its largest number


# --- Reach, fit, words ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Reached:
    """A vector with its reach, by the definitions."""

    document: Document
    K: Any = field(init=False)
    spread: Fraction = field(init=False)
    c: Fraction = field(init=False)

    def __post_init__(self) -> None:
        content = b64decode(self.document["problem"]["data"])
        n = self.document["problem"]["n"]
        numbers = np.frombuffer(content[len(PREFIX) + 8 :])
        met = self.document["claims"]["labels"].count("i")
        x, y = (numbers[k : k + 3 * met].reshape(-1, 3) for k in (0, 3 * n))
        w, b = (numbers[k : k + met] for k in (6 * n, 7 * n))
        mass, C, S = oracle.exact_moments(x, y, w)
        _, _, T = oracle.exact_moments(y, x, w)
        spread = sum((A[k][k] for A in (S, T) for k in range(3)), Fraction(0))
        bound = sum(Fraction(float(p)) * Fraction(float(q)) ** 2 for p, q in zip(w, b, strict=True))
        del mass
        object.__setattr__(self, "K", oracle.rotation_form(C))
        object.__setattr__(self, "spread", spread)
        object.__setattr__(self, "c", spread - bound)

    def proves(self, s: Fraction, tau: Fraction) -> bool:
        q = self.document["fit"]["pose"]
        norm, t = sum(k * k for k in q), tau * self.spread
        return oracle.positive_definite(
            [
                [
                    (self.c - t * (1 - s)) * (i == j) - 2 * self.K[i][j] + t * q[i] * q[j] / norm
                    for j in range(4)
                ]
                for i in range(4)
            ]
        )

    def told(self, s: Fraction, tau: Fraction) -> Document:
        return self.document | {"reach": {"sin2_half_angle": dyadic(s), "tau": dyadic(tau)}}


def reach_cases() -> Iterator[Case]:
    for name in ("accept-consensus", "accept-consensus-uneven", "accept-consensus-two-groups"):
        case = Reached(document_of(name))
        tau = Fraction(1, 2)
        s = edge(lambda k, c=case, t=tau: c.proves(k, t), Fraction(1, 2**20), Fraction(1, 2))
        for factor, answer in ((1 + NEAR, "VERIFIED"), (1 - NEAR, "REFUSED: reach is not proved$")):
            yield Case(f"{name} s {factor}", outcome_of(case.told(s * factor, tau)), answer)
        wide = Fraction(1, 16)
        for end in (Fraction(1, 2**20), Fraction(8)):
            t = edge(lambda k, c=case, s=wide: c.proves(s, k), end, tau)
            inside, outside = t + (tau - t) * NEAR, t - (tau - t) * NEAR
            for value, answer in ((inside, "VERIFIED"), (outside, "REFUSED: reach is not proved$")):
                yield Case(f"{name} tau {end} {answer}", outcome_of(case.told(wide, value)), answer)
        for s, tau in ((1, 1), (2, 1), (-1, 1), (0, 1)):
            spoilt = case.told(Fraction(s), Fraction(tau))
            yield Case(f"{name} s = {s}", outcome_of(spoilt), "REFUSED: reach is not")
    good = document_of()
    reach, fit = good["reach"], good["fit"]
    w, x, y, z = fit["pose"]
    claims = fit["claims"] | {"gap": [1, 40], "sin2_half_angle": None, "sdp_gap": None}
    loose = {"claims": claims | {"basin": None}, "optimality": {"delta": [1, 39], "mu": [0, 0]}}
    turned = good | {"fit": fit | loose | {"pose": [-x, w, -z, y], "basin": None, "sdp": None}}
    away = turned | {"reach": {"sin2_half_angle": [1, -30], "tau": [-1, 3]}}
    yield Case("a loose fit", outcome_of(turned | {"reach": None}), "VERIFIED")
    yield Case("all away from a loose fit", outcome_of(away), "REFUSED: reach is not proved$")
    for name, parts, answer in (
        ("null", {"reach": None}, "VERIFIED"),
        ("of nulls", {"reach": {"sin2_half_angle": None, "tau": None}}, "VERIFIED"),
        ("without tau", {"reach": reach | {"tau": None}}, "REFUSED: reach is not of a fit"),
        (
            "without s",
            {"reach": reach | {"sin2_half_angle": None}},
            "REFUSED: reach is not of a fit",
        ),
        ("without fit", {"fit": None}, "REFUSED: reach is not of a fit"),
        ("of a count", {"fit": fit | {"kind": "count"}}, "REFUSED: fit is of another kind$"),
        (
            "of a gap",
            {"fit": fit | {"claims": fit["claims"] | {"gap": [1, -999]}}},
            "REFUSED: fit is",
        ),
    ):
        yield Case(f"reach {name}", outcome_of(good | parts), answer)
    told = r"VERIFIED.*has its rotation within 2\.06e\+1 degrees of R, that of the pose below\.\n"
    yield Case("reach in degrees", outcome_of(good), told)


def edge(holds: Any, low: Fraction, high: Fraction) -> Fraction:
    """Where what does not hold at `low` and holds at `high` begins to, to 60 bits."""
    assert not holds(low)
    assert holds(high)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def word_cases() -> Iterator[Case]:
    told = {
        "accept-consensus": (
            r"VERIFIED\nData: n = 12 pairs, each with a bound\. SHA-256 of their doubles is \S+\."
            r"\nBounds: .*\nThe clouds .*"
            r"\nOne rigid motion brings 6 of the 12 pairs within their bounds\."
            r"\nNo rigid motion brings more than 6 within\."
            r"\nEvery motion that brings 6 within brings these 6 within, and only these\."
            r"\nIn EVERY motion that brings 6 within: outliers: 6, inliers: 6\."
            r"\nEvery motion .*\nOf the least squares over these 6 pairs:\nData: n = 6 pairs"
        ),
        "accept-consensus-undecided": (
            r"VERIFIED\n.*more than 6 within\."
            r"\nIn EVERY motion that brings 6 within: outliers: 1, inliers: 5\."
            r"\nNot proved: which of the other 2 pairs are\.\n"
        ),
        "accept-consensus-upper-alone": (
            r"VERIFIED\n.*more than 6 within\.\nIn EVERY .*: outliers: 0, inliers: 0.*"
            r"\nNot proved: which of the other 8 pairs are\."
            r"\nNot proved: anything under `about`, and where the points come from\.$"
        ),
        "accept-consensus-claims-less": (
            r"VERIFIED\n.*more than 9 within\.\nIn .*: outliers: 1, inliers: 1\."
        ),
    }
    for name, answer in told.items():
        yield Case(f"words of {name}", outcome_of(vector(name).encode()), answer)
    once = value_of(
        lambda checker: [
            line.startswith("Not proved: anything")
            for line in checker.check(vector("accept-consensus").encode()).theorems
        ].count(True)
    )
    yield Case("not proved is said once", once, "1$")
    worth = value_of(
        lambda checker: checker.check(vector("accept-consensus").encode()).worth.weight
    )
    yield Case("worth is that of the fit", worth, r"Fraction\(6, 1\)$")
    yield from cloud_cases()


def cloud_cases() -> Iterator[Case]:
    """Points, weights and bounds that are given beside."""
    good = document_of("accept-consensus-uneven")
    n = good["problem"]["n"]
    numbers = np.frombuffer(b64decode(good["problem"]["data"])[len(PREFIX) + 8 :]).tolist()
    parts = [numbers[: 3 * n], numbers[3 * n : 6 * n], numbers[6 * n :]]
    without = good | {"problem": good["problem"] | {"data": None}}

    def ask(document: Document, clouds: Any, model: str) -> Any:
        def asked(checker: Any) -> str:
            given = checker.Clouds(*(None if p is None else tuple(p) for p in clouds), model)
            return outcome_of(document, given)(checker)

        return asked

    others = [*parts[2][:-1], parts[2][-1] + 1]
    hint = r"REFUSED: the certified bounds or weights are others, or not given: .*--max-residual$"
    for name, document, clouds, model, answer in (
        ("given", good, parts, "--max-residual", "VERIFIED"),
        ("given alone", without, parts, "--max-residual", "VERIFIED"),
        ("not given", good, [*parts[:2], None], "--max-residual", hint),
        ("not given alone", without, [*parts[:2], None], "--max-residual", hint),
        ("others", good, [*parts[:2], others], "--max-residual", hint),
        ("others alone", without, [*parts[:2], others], "--max-residual", "REFUSED: the digest"),
        ("weights alone", good, [*parts[:2], parts[2][:n]], "--max-residual", "REFUSED: the cert"),
        ("of no bounds", good, parts, "", "REFUSED: the certificate has --max-residual: give the"),
    ):
        yield Case(f"clouds {name}", ask(document, clouds, model), answer)


@cache
def consensus_cases() -> list[Case]:
    parts = (
        *(vector_cases, length_cases, witness_cases, graph_cases, group_cases, stage_cases),
        *(size_cases, reach_cases, word_cases, turning_cases),
    )
    return [case for part in parts for case in part()]
