"""Certificates of consensus: which pairs every motion that meets the most of them meets."""

from __future__ import annotations

import copy
import struct
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

import isotropic
from envelope import ABOUT, FORMAT, Certificate, Points, Vectors, lower, of_another_digest, stated

from certreg.verify import CONSENSUS, ConsensusStatement, bounded_rows, definite, weighed

PREFIX = CONSENSUS
TURN = [1, 1, 1, 1]  # takes (x, y, z) to (z, x, y)
SHIFT = [5, -3, 2, 0]
CLASS = "consensus"

# Six are met; of the other six two have too few neighbours, two of too few colours, two fall by a
# group each.
BODY: Points = [[-4, -6, 1], [0, -3, -2], [6, -4, 5], [6, -1, 1], [-5, -3, 2], [-6, 4, -5]]
WRONG: Points = [[1, -6, -5], [-2, 3, -6], [-3, 6, 5], [0, 2, -2], [-2, 5, 3], [2, 0, 0]]
ELSEWHERE: Points = [[5, -1, 2], [10, -6, 8], [8, -5, 7], [-1, -5, 5], [3, -3, 4], [0, -2, -4]]
PLATE: Points = [[4, 0, 0], [-4, 3, 0], [-4, -3, 0], [-5, 0, 0], [5, 3, 0], [5, -4, 0]]


@dataclass(frozen=True)
class Pairs:
    """Points, a bound and a weight each; the first `met` are met by the witness."""

    source: Points
    target: Points
    bounds: list[float]
    weights: list[float]
    met: int

    @property
    def content(self) -> bytes:
        """The bytes that the digest binds."""
        numbers = [*chain(*self.source), *chain(*self.target), *self.weights, *self.bounds]
        head = PREFIX + struct.pack("<Q", len(self.source))
        return head + struct.pack(f"<{len(numbers)}d", *map(float, numbers))


def moved(points: Points) -> Points:
    """By TURN and SHIFT."""
    return [[z + SHIFT[0], x + SHIFT[1], y + SHIFT[2]] for x, y, z in points]


def paired(source: Points, target: Points, met: int, bound: float = 1.0) -> Pairs:
    """With one bound and one weight."""
    return Pairs(source, target, [bound] * len(source), [1.0] * len(source), met)


MIXED = paired(BODY + WRONG, moved(BODY) + ELSEWHERE, 6)
FEW_COLOURS: list[Any] = [[7], [10], [6, [[4, 0, 1], [1, 1, 1, 1]]]]
MIXED_STAGES: list[Any] = [[6, 12, [*FEW_COLOURS, [8, [[3, 5, 4], [1, 1, 1, 1]]]]]]
PLATE_STAGES: list[Any] = [[6, 7, [[6, [[0, 1, 2], [1, 1, 1, 1]], [[3, 4, 5], [1, 1, 1, 1]]]]]]
PLATE_GROUPS = [[0, 1, 2], [0, 3, 4], [1, 3, 5]]  # no row is in all: two are missed
PLATE_SHARED: list[Any] = [[6, 7, [[6, *[[T, [1, 1, 1, 1]] for T in PLATE_GROUPS]]]]]
PLATE_PARTED: list[Any] = [[6, 7, [[[6, 0]], [[1, 6]]]]]  # too few neighbours are left
# A line, and a pair that is lifted off it: opposite ends, of two targets each, are refuted with it.
# Two pairs hit all of these groups, which with two others that it goes with are enough; but no two
# ends go together that are no group. Then the second targets of the ends fall.
LINE: Points = [[900, 0, 0], [-900, 0, 0], [0, 300, 0], [700, 0, 0], [-700, 0, 0]]
LIFTED: Points = [[0, 0, 0], LINE[0], LINE[1]]
LIFTED_TO: Points = [[0, 30, 0], [900, 0, 25], [-900, 0, 25]]
SIDES = [[0, 1], [1, 6], [6, 7], [7, 0]]
SIDE_GROUPS: list[Any] = [[T, [2, 1, 1]] for T in SIDES]
SECOND_ENDS: list[Any] = [[6, [[3, 4], [2, 2, 1]]], [7, [[4, 3], [2, 2, 1]]]]
CLIQUES: list[Any] = [[5, 8, [[5, *SIDE_GROUPS], *SECOND_ENDS]]]
PAIR_GROUPS: list[Any] = [[T, [2, 0, 1, 1]] for T in SIDES]
CLIQUES_OF_TWO: list[Any] = [[5, 8, [[[5, 3], *PAIR_GROUPS]]]]
SHARED_STAGES: list[Any] = [[6, 8, []], [7, 8, []], *[[6, i, []] for i in range(1, 6)]]


def uneven() -> Pairs:
    """Bounds and weights that differ, one residual that is its bound exactly."""
    (a, b, c), *others = MIXED.target
    bounds = [0.625, 1, 0.5, 0.75, 1, 1, 1, 1, 1, 1, 1, 1]
    weights = [1, 2, 1, 0.5, 3, 1, 1, 0, 1, 1, 1, 7]
    return Pairs(MIXED.source, [[a + 0.375, b - 0.5, c], *others], bounds, weights, 6)


def far_off() -> Pairs:
    """A hundred million units away."""
    away = [10**8, 2 * 10**8, -(10**8)]

    def moved_away(points: Points) -> Points:
        return [[k + o for k, o in zip(row, away, strict=True)] for row in points]

    return replace(MIXED, source=moved_away(MIXED.source), target=moved_away(MIXED.target))


def mirrored() -> Pairs:
    """A plate, and a point above it that is below afterwards: all lengths are kept."""
    return paired([*PLATE, [0, 0, 2]], [*moved(PLATE), *moved([[0, 0, -2]])], 6, 0.5)


def lifted() -> Pairs:
    """Five are met; the lifted one, and two more targets of the ends of the line, are not."""
    return paired([*LINE, *LIFTED], [*moved(LINE), *moved(LIFTED_TO)], 5, 10.0)


def shared() -> Pairs:
    """A source point with two targets: all other pairs agree with either."""
    (a, b, c), *_ = moved(BODY)
    targets = [*moved(BODY), [a, b, c + 2.125], [40, 40, 40]]
    return paired([*BODY, BODY[0], [0, 0, 0]], targets, 6)


def produced(
    pairs: Pairs, stages: list[Any], labels: str, upper: int, **witness: list[int]
) -> Certificate:
    """A certificate, with that of the least squares and the reach that follows."""
    rows = slice(pairs.met)
    fit = isotropic.produced(pairs.source[rows], pairs.target[rows], pairs.weights[rows])
    fit["problem"]["data"] = None
    return {
        "about": ABOUT,
        "claims": {"labels": labels, "upper": upper},
        "fit": fit,
        "format": FORMAT,
        "kind": ConsensusStatement.kind,
        "problem": stated(pairs.content, len(pairs.source)),
        "reach": reach(rows_of(pairs), fit["pose"]),
        "stages": stages,
        "witness": {"quaternion": TURN, "shift": SHIFT} | witness,
    }


def rows_of(pairs: Pairs) -> list[list[int]]:
    """Those that are met, as the checker reads them."""
    table, _ = bounded_rows(pairs.content[len(PREFIX) + 8 :], len(pairs.source))
    return table[: pairs.met]


def reach(rows: list[list[int]], q: list[int]) -> dict[str, list[int]]:
    """Of rigid motions."""
    squares, bound, K = weighed(rows, [row[6] for row in rows])
    return least_reach(K, squares - bound, squares, q)


def least_reach(K: list[list[int]], c: int, size: int, q: list[int]) -> dict[str, list[int]]:
    """The least power of two that is proved, and the number that proves it.

    Of motions p with 2 p^T K p >= c; the number is in shares of size.
    """
    norm = sum(k * k for k in q)
    found = {"sin2_half_angle": [1, 0], "tau": [1, 0]}
    for k in range(1, 20):
        for j in range(-4, 20):
            # s = 2^-k, tau = 2^-j: all times 2^(k + j + 4), which makes integers of both.
            scale, s_less, tau = 1 << k + j + 4, (1 << k) - 1, 16 << k
            level = (c * scale - 16 * s_less * size) * norm
            A = [
                [
                    tau * size * a * b - 2 * norm * scale * K[i][h] + level * (i == h)
                    for h, b in enumerate(q)
                ]
                for i, a in enumerate(q)
            ]
            if definite(A):
                found = {"sin2_half_angle": [1, -k], "tau": [1, -j]}
                break
    return found


def accepted() -> dict[str, Certificate]:
    """All labels proved, some, none; by every rule."""
    mixed, off = "iiiiiioooooo", far_off()
    all_met = paired(BODY, moved(BODY), 6)
    o = off.source[0]
    shift = [b - a for a, b in zip([o[2], o[0], o[1]], off.target[0], strict=True)]
    long = {"quaternion": [-7, -7, -7, -7], "shift": [40, -24, 16, -3]}
    good = produced(MIXED, MIXED_STAGES, mixed, 6)
    return {
        "": good,
        "-no-outliers": produced(all_met, [], "iiiiii", 6),
        "-uneven": produced(uneven(), [[6, 12, FEW_COLOURS]], mixed, 6, **long),
        "-far-off": produced(off, MIXED_STAGES, mixed, 6, shift=[*map(int, shift), 0]),
        "-two-groups": produced(mirrored(), PLATE_STAGES, "iiiiiio", 6),
        "-shared-groups": produced(mirrored(), PLATE_SHARED, "iiiiiio", 6),
        "-struck-together": bare(produced(mirrored(), PLATE_PARTED, "iiiiiio", 6)),
        "-cliques": bare(produced(lifted(), CLIQUES, "iiiiiooo", 5)),
        "-cliques-beside-two": bare(produced(lifted(), CLIQUES_OF_TWO, "?" * 8, 8)),
        "-undecided": produced(shared(), SHARED_STAGES, "?iiiii?o", 6),
        "-upper-alone": bare(produced(shared(), SHARED_STAGES[:2], "?" * 8, 6)),
        "-claims-less": bare(claim(good, labels="i?????o?????", upper=9)),
        "-without-stages": bare(good | {"claims": {"labels": "?" * 12, "upper": 12}, "stages": []}),
    }


def bare(good: Certificate) -> Certificate:
    """Without least squares."""
    left = {name: value for name, value in good.items() if name != "reach"}
    return left | {"fit": None}


def claim(good: Certificate, **parts: Any) -> Certificate:
    """Other claims."""
    return good | {"claims": good["claims"] | parts}


def vectors() -> Vectors:
    """True ones, and forgeries: one for each thing that is asked of a file."""
    made = accepted()
    forged = of_data() | of_claims(made) | of_stages(made) | of_groups(made) | of_pairs(made)
    forged |= of_fit(made)
    return {
        **{f"accept-consensus{name}.json": (good, "") for name, good in made.items()},
        **{f"refuse-consensus-{name}.json": pair for name, pair in forged.items()},
    }


def of_data() -> Vectors:
    """Of bounds, the witness and what it meets."""
    claims = "iiiiiioooooo", 6

    def with_first(bound: float, weight: float) -> Certificate:
        bounds, weights = [bound, *MIXED.bounds[1:]], [weight, *MIXED.weights[1:]]
        pairs = replace(MIXED, bounds=bounds, weights=weights)
        return stated(pairs.content, 12)

    good = bare(produced(MIXED, MIXED_STAGES, *claims))
    longer = uneven()
    short = replace(longer, bounds=[0.625 - 2.0**-30, *longer.bounds[1:]])
    content = isotropic.data_bytes(MIXED.source, MIXED.target, MIXED.weights)
    far = witness(good, shift=[500, 0, 0, 0])
    return {
        "digest": (of_another_digest(good), "data"),
        "data-without-bounds": (good | {"problem": stated(content, 12)}, "data"),
        "bound-not-finite": (good | {"problem": with_first(float("inf"), 1)}, "data"),
        "bound-zero": (good | {"problem": with_first(0, 1)}, CLASS),
        "bound-negative": (good | {"problem": with_first(-1, 1)}, CLASS),
        "weight-negative": (good | {"problem": with_first(1, -1)}, CLASS),
        "sizes-too-far-apart": (good | {"problem": with_first(2.0**-800, 1)}, "data"),
        "witness-zero": (witness(good, quaternion=[0, 0, 0, 0]), CLASS),
        "witness-meets-none": (far, CLASS),
        "witness-meets-fewer": (bare(produced(short, MIXED_STAGES, *claims)), CLASS),
        "witness-of-an-exponent-too-large": (witness(good, shift=[0, 0, 0, 32769]), CLASS),
    }


def witness(good: Certificate, **parts: list[int]) -> Certificate:
    """With another motion."""
    return good | {"witness": good["witness"] | parts}


def of_claims(made: dict[str, Certificate]) -> Vectors:
    """Labels and bounds that are not proved."""
    good, none = bare(made["-undecided"]), bare(made["-without-stages"])
    forged = {
        "label-i-of-one-undecided": claim(good, labels="iiiiii?o"),
        "label-i-of-one-not-met": claim(good, labels="?iiiiiio"),
        "label-o-of-one-undecided": claim(good, labels="?iiiiioo"),
        "label-i-of-an-outlier": claim(good, labels="?iiiii?i"),
        "label-o-of-one-met": claim(good, labels="?oiiii?o"),
        "label-of-another-letter": claim(good, labels="?iiiii?x"),
        "labels-too-few": claim(good, labels="?iiiii?"),
        "labels-too-many": claim(good, labels="?iiiii?o?"),
        "labels-by-no-stage": claim(none, labels="???????????o"),
        "upper-by-no-stage": claim(none, upper=11),
        "upper-one-less": claim(bare(made[""]), upper=5),
        "upper-without-its-stage": good | {"stages": [SHARED_STAGES[0], *SHARED_STAGES[2:]]},
    }
    return {name: (found, CLASS) for name, found in forged.items()}


def of_stages(made: dict[str, Certificate]) -> Vectors:
    """Stages that are none, or not in their place."""
    good = bare(made["-undecided"])
    one, two, *left_out = SHARED_STAGES
    lists = {
        "stage-of-two-entries": [[6, 8], two],
        "stage-first-of-another-number": [[5, 8, []], two, *left_out],
        "stage-first-of-one-more": [[7, 8, []]],
        "stage-first-leaves-one-out": [[6, 1, []], one, two, *left_out],
        "stage-of-fewer": [one, two, [6, 8, []], *left_out],
        "stage-leaves-out-of-one-more": [one, two, [7, 1, []], *left_out[1:]],
        "stage-leaves-out-of-fewer": [one, two, [5, 1, []], *left_out[1:]],
        "stage-number-true": [[True, 8, []], two, *left_out],
        "stage-number-too-large": [one, [10, 8, []]],
        "stage-leaves-out-row-too-large": [one, two, [6, 9, []]],
        "step-of-a-struck-row": [[6, 8, [[7]]], two, *left_out],
        "step-of-a-row-that-stays": [[6, 8, [[0]]], two, *left_out],
        "step-without-a-row": [[6, 8, [[]]], two, *left_out],
        "step-that-is-a-number": [[6, 8, [6]], two, *left_out],
        "step-of-a-row-that-is-none": [[6, 8, [[8]]], two, *left_out],
        "step-of-a-row-below-0": [[6, 8, [[-1]]], two, *left_out],
    }
    forged = {name: (good | {"stages": stages}, CLASS) for name, stages in lists.items()}
    return forged | {"stages-in-an-object": (good | {"stages": {"0": one}}, "form")}


def of_groups(made: dict[str, Certificate]) -> Vectors:
    """Groups that do not refute, or do not strike."""
    good, mixed = bare(made["-two-groups"]), bare(made[""])
    one, two = PLATE_STAGES[0][2][0][1:]
    groups: dict[str, list[Any]] = {
        "group-left-out": [one],
        "group-of-another-with-a-shared-row": [one, [[2, 3, 4], [1, 1, 1, 1]]],
        "group-of-the-row-itself": [one, [[6, 4, 5], [1, 1, 1, 1]]],
        "group-of-a-row-twice": [one, [[3, 3, 5], [1, 1, 1, 1]]],
        "group-of-no-row": [one, [[], [1]]],
        "group-of-a-row-that-is-none": [one, [[3, 4, 7], [1, 1, 1, 1]]],
        "group-of-a-row-beyond-memory": [one, [[3, 4, 1 << 200], [1, 1, 1, 1]]],
        "group-of-one-weight-less": [one, [[3, 4, 5], [1, 1, 1]]],
        "group-of-no-weights": [one, [[3, 4, 5], [0, 0, 0, 0]]],
        "group-of-a-weight-below-0": [one, [[3, 4, 5], [1, 1, 1, -1]]],
        "group-of-a-weight-too-large": [one, [[3, 4, 5], [1, 1, 1, 1 + (1 << 256)]]],
        "group-not-refuted-by-its-weights": [one, [[3, 4, 5], [0, 1, 1, 1]]],
        "group-of-three-entries": [one, [*two, []]],
    }
    found = {
        name: (good | {"stages": [[6, 7, [[6, *parts]]]]}, CLASS) for name, parts in groups.items()
    }
    stage = copy.deepcopy(MIXED_STAGES)
    stage[0][2][2][1][0] = [7, 0, 1]
    struck = mixed | {"stages": stage}
    return found | {
        "group-of-a-struck-row": (struck, CLASS),
        "step-of-too-many-colours": (mixed | {"stages": [[6, 12, [[7], [10], [6]]]]}, CLASS),
    }


def of_pairs(made: dict[str, Certificate]) -> Vectors:
    """Rows that are not struck together, or that are no two."""
    good = made["-struck-together"]
    one = PLATE_PARTED[0][2][0]
    lists: dict[str, list[Any]] = {
        "pair-left-out": [one],
        "pair-twice-turned": [one, [[0, 6]]],
        "pair-of-met-rows": [one, [[1, 2]]],
        "pair-of-one-row": [one, [[6, 6]]],
        "pair-with-a-group-not-refuted": [one, [[1, 6], [[2, 3], [1, 0, 1, 1]]]],
    }
    found = {name: (good | {"stages": [[6, 7, steps]]}, CLASS) for name, steps in lists.items()}
    alone, two = made["-cliques"], made["-cliques-beside-two"]
    return found | {
        "cliques-of-a-group-less": (
            alone | {"stages": [[5, 8, [[5, *SIDE_GROUPS[:3]], *SECOND_ENDS]]]},
            CLASS,
        ),
        "cliques-without-groups": (alone | {"stages": [[5, 8, [[5], *SECOND_ENDS]]]}, CLASS),
        "cliques-beside-two-of-a-group-less": (
            two | {"stages": [[5, 8, [[[5, 3], *PAIR_GROUPS[1:]]]]]},
            CLASS,
        ),
    }


def of_fit(made: dict[str, Certificate]) -> Vectors:
    """A least squares of other pairs, or refused, and a reach that is not proved."""
    good = made[""]
    fit, r = good["fit"], good["reach"]
    m, e = r["sin2_half_angle"]
    other = made["-uneven"]["fit"]
    claims = fit["claims"] | {"gap": lower(fit["claims"]["gap"])}
    forged = {
        "fit-of-another-gap": good | {"fit": fit | {"claims": claims}},
        "fit-of-other-weights": good | {"fit": other},
        "fit-of-all-pairs": good | {"fit": fit | {"problem": fit["problem"] | {"n": 12}}},
        "fit-of-another-kind": good | {"fit": fit | {"kind": "count"}},
        "fit-of-itself": good | {"fit": bare(good)},
        "fit-of-rotations-alone": good | {"fit": fit | {"rotation_only": True}},
        "reach-too-small": good | {"reach": r | {"sin2_half_angle": [m, e - 1]}},
        "reach-of-another-number": good | {"reach": r | {"tau": [-1, 0]}},
        "reach-of-a-half": good | {"reach": r | {"tau": None}},
        "reach-without-a-fit": good | {"fit": None},
        "reach-of-all-rotations": good | {"reach": {"sin2_half_angle": [1, 0], "tau": [1, 0]}},
    }
    found = {name: (parts, CLASS) for name, parts in forged.items()}
    return found | {
        "fit-that-is-a-list": (good | {"fit": [fit]}, "form"),
        "witness-of-five-numbers": (witness(bare(good), quaternion=[1, 1, 1, 1, 0]), "form"),
        "with-a-pose": (bare(good) | {"pose": TURN}, "form"),
    }
