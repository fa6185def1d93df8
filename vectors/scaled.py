"""Certificates of consensus with a free scale: pieces of scale, each with its stages."""

from __future__ import annotations

import copy
import struct
from itertools import chain
from math import isqrt
from typing import Any

import similarity
from consensus import BODY, ELSEWHERE, SHIFT, TURN, WRONG, bare, claim, least_reach, witness
from envelope import ABOUT, FORMAT, Certificate, Points, Vectors, of_another_digest, stated

from certreg.verify import (
    ConsensusSimilarityStatement,
    bounded_rows,
    scaled_refuted,
    weighed_parts,
)

PREFIXES = ConsensusSimilarityStatement.prefixes
CLASS = "consensus"
BITS = 12  # of the bounds of a scale


def doubled(points: Points) -> Points:
    """By a scale of 2, by TURN and SHIFT."""
    return [[2 * z + SHIFT[0], 2 * x + SHIFT[1], 2 * y + SHIFT[2]] for x, y, z in points]


# Six are met at the scale 2; two have too few neighbours at any scale.
SOURCE: Points = BODY + WRONG[:2]
TARGET: Points = doubled(BODY) + ELSEWHERE[:2]
NEAR: list[Any] = [[[7, -2], [[6, 8, []]]], [[9, -2], [[6, 8, []]]], [None, [[6, 8, []]]]]
# The first pair again, with its target 2.125 away: from 15/8 to 2 either is met with the others.
TWICE: Points = [*BODY, BODY[0]]
(_FIRST, *_), _APART = doubled(BODY), [0, 0, 2.125]
TARGETS: Points = [*doubled(BODY), [a + b for a, b in zip(_FIRST, _APART, strict=True)]]
GROUP: list[Any] = [6, [[4, 5, 1], [33, 17, 10, 9]]]
LEFT_OUT: list[Any] = [[6, 7, []], [7, 7, []], *[[6, i, []] for i in range(1, 6)]]
PIECES: list[Any] = [
    [[7, -2], [[6, 7, []]]],
    [[15, -3], [[6, 7, [[5]]]]],
    [[2, 0], LEFT_OUT],
    [[9, -2], [[6, 7, [GROUP]]]],
    [None, [[6, 7, []]]],
]
# Four targets within a bound of one place are met where the source is small enough.
HEAP: Points = [[0, 0, 0], [8, 0, 0], [0, 8, 0], [0, 0, 8], [1, 2, 3], [-5, 7, 1]]
HEAPED: Points = [[16, 0, 0], [16.5, 0, 0], [16, 0.5, 0], [16, 0, 0.5], [56, 0, 9], [-14, 50, 7]]
HEAP_PIECES: list[Any] = [[[1, -1], [[4, 6, []]]], [None, [[4, 6, []]]]]


def data_bytes(source: Points, target: Points, scale: str, bound: float = 1.0) -> bytes:
    """The bytes that the digest binds; all weights are 1."""
    n = len(source)
    numbers = [*chain(*source), *chain(*target), *[1.0] * n, *[bound] * n]
    return PREFIXES[scale] + struct.pack(f"<Q{8 * n}d", n, *map(float, numbers))


def produced(
    source: Points,
    target: Points,
    pieces: list[Any],
    claims: tuple[str, str, int],
    met: int,
    *,
    scale: str = "asymmetric",
    **motion: list[int],
) -> Certificate:
    """A certificate, with that of the least squares and what follows of the scale."""
    content, (labels, states, upper) = data_bytes(source, target, scale), claims
    rows = slice(met)
    own = similarity.PREFIXES[scale, False]
    fit = similarity.produced(source[rows], target[rows], own, scale, alone=False)
    fit["problem"]["data"] = None
    low, high, reach = bounded(source[rows], target[rows], scale, fit["pose"])
    return {
        "about": ABOUT,
        "claims": {
            "labels": labels,
            "scale_lower": low,
            "scale_upper": high,
            "states": states,
            "upper": upper,
        },
        "fit": fit,
        "format": FORMAT,
        "kind": ConsensusSimilarityStatement.kind,
        "pieces": pieces,
        "problem": stated(content, len(source)),
        **reach,
        "scale": scale,
        "witness": {"factor": [2, 0], "quaternion": TURN, "shift": SHIFT} | motion,
    }


def bounded(
    source: Points, target: Points, scale: str, q: list[int]
) -> tuple[list[int], list[int], dict[str, Any]]:
    """The narrowest bounds of the scale of so many bits, and the least reach, a power of two."""
    content = data_bytes(source, target, scale)[len(PREFIXES[scale]) + 8 :]
    rows, _ = bounded_rows(content, len(source))
    x, y, bound, K = weighed_parts(rows, [1] * len(rows))
    c, one = y - bound, 1 << BITS

    def refuted(low: int, high: int | None) -> bool:
        form = [[k * one for k in row] for row in K]
        return scaled_refuted(x, c * one * one, form, low, high)

    middle = isqrt(y * one * one // x)
    low = max((k for k in range(middle) if k and refuted(0, k)), default=0)
    high = next(k for k in range(max(middle, 1), 64 * one) if refuted(k, None))
    near = {"reach": least_reach(K, 2 * isqrt(c * x), isqrt(x * y), q)} if c > 0 else {}
    return [low, -BITS], [high, -BITS], near


def accepted() -> dict[str, Certificate]:
    """All labels proved, some, none; at both ends of the scales."""
    good = produced(SOURCE, TARGET, NEAR, ("iiiiiioo", "-=-", 6), 6)
    heap = produced(
        HEAP,
        HEAPED,
        HEAP_PIECES,
        ("iiiioo", "=-", 4),
        4,
        factor=[1, -10],
        quaternion=[1, 0, 0, 0],
        shift=[129, 1, 1, -3],
    )
    none = {"pieces": [[None, []]]}
    return {
        "": good,
        "-symmetric": produced(SOURCE, TARGET, NEAR, ("iiiiiioo", "-=-", 6), 6, scale="symmetric"),
        "-open": produced(TWICE, TARGETS, PIECES, ("?iiiii?", "--?=-", 6), 6),
        "-near-0": heap,
        "-claims-less": bare(claim(good, labels="i?????o?", states="=??", upper=7)),
        "-without-stages": bare(claim(good, labels="?" * 8, states="?", upper=8) | none),
    }


def vectors() -> Vectors:
    """True ones, and forgeries: one for each thing that is asked of a file."""
    made = accepted()
    forged = of_claims(made) | of_pieces(made) | of_the_rest(made)
    return {
        **{f"accept-scaled-pairs{name}.json": (good, "") for name, good in made.items()},
        **{f"refuse-scaled-pairs-{name}.json": pair for name, pair in forged.items()},
    }


def of_claims(made: dict[str, Certificate]) -> Vectors:
    """Labels, states and bounds that are not proved."""
    good, some = bare(made[""]), bare(made["-open"])
    low, high = (good["claims"][f"scale_{end}"][0] for end in ("lower", "upper"))
    forged = {
        "label-i-of-one-undecided": claim(some, labels="iiiiii?"),
        "label-o-of-one-undecided": claim(some, labels="?iiiiio"),
        "label-i-of-an-outlier": claim(good, labels="iiiiiiio"),
        "states-of-an-open-piece": claim(some, states="--==-"),
        "states-of-a-piece-with-the-same": claim(some, states="--?--"),
        "states-too-few": claim(some, states="--?="),
        "states-too-many": claim(some, states="--?=--"),
        "states-of-another-letter": claim(some, states="--?=o"),
        "upper-one-less": claim(good, upper=5),
        "scale-lower-one-more": claim(good, scale_lower=[low + 1, -BITS]),
        "scale-upper-one-less": claim(good, scale_upper=[high - 1, -BITS]),
        "scale-lower-negative": claim(good, scale_lower=[-1, 0]),
    }
    return {name: (found, CLASS) for name, found in forged.items()}


def of_pieces(made: dict[str, Certificate]) -> Vectors:
    """Pieces that do not cover all scales, or in which nothing is proved."""
    good, some = bare(made[""]), bare(made["-open"])
    one, two, three = NEAR
    opened = copy.deepcopy(PIECES)
    opened[3][1][0][2][0] = [6, [[4, 5, 1], [33, 1, 1, 1]]]
    lists = {
        "piece-first-left-out": claim(good, states="=-") | {"pieces": [two, three]},
        "piece-last-left-out": claim(good, states="-=") | {"pieces": [one, two]},
        "pieces-in-another-order": good | {"pieces": [two, one, three]},
        "pieces-twice": claim(good, states="-==-") | {"pieces": [one, two, two, three]},
        "piece-from-0": claim(good, states="--=-") | {"pieces": [[[0, 0], []], *NEAR]},
        "piece-last-with-an-end": good | {"pieces": [one, two, [[9, 0], three[1]]]},
        "piece-without-an-end": good | {"pieces": [one, [None, two[1]], three]},
        "piece-that-is-too-wide": good | {"pieces": [[[2, 0], one[1]], two, three]},
        "piece-with-an-end-true": good | {"pieces": [[[True, 0], one[1]], two, three]},
        "piece-of-three-entries": good | {"pieces": [[*one, []], two, three]},
        "no-pieces": claim(good, states="") | {"pieces": []},
        "piece-stage-of-one-more": good | {"pieces": [one, [two[0], [[7, 8, []]]], three]},
        "piece-stage-of-one-less": good | {"pieces": [one, [two[0], [[5, 8, []]]], three]},
        "piece-group-not-refuted": some | {"pieces": opened},
        "piece-step-without-a-group": some
        | {"pieces": [*PIECES[:3], [[9, -2], [[6, 7, [[6]]]]], PIECES[4]]},
    }
    return {name: (found, CLASS) for name, found in lists.items()}


def of_the_rest(made: dict[str, Certificate]) -> Vectors:
    """The witness, the model, the fit, the reach, the form."""
    good = made[""]
    plain, fit, r = bare(good), good["fit"], good["reach"]
    m, e = r["sin2_half_angle"]
    other = made["-symmetric"]["fit"]
    content = data_bytes(SOURCE, TARGET, "symmetric")
    return {
        "digest": (of_another_digest(plain), "data"),
        "data-of-the-other-scale": (plain | {"problem": stated(content, 8)}, "data"),
        "scale-of-another-name": (plain | {"scale": "none"}, "data"),
        "witness-of-another-scale": (witness(plain, factor=[3, 0]), CLASS),
        "witness-of-scale-0": (witness(plain, factor=[0, 0]), CLASS),
        "witness-without-a-scale": (
            plain | {"witness": {"quaternion": TURN, "shift": SHIFT}},
            "form",
        ),
        "fit-of-the-other-scale": (good | {"fit": other}, CLASS),
        "fit-without-a-scale": (good | {"fit": fit | {"kind": "isotropic"}}, CLASS),
        "reach-too-small": (good | {"reach": r | {"sin2_half_angle": [m, e - 1]}}, CLASS),
        "with-stages": (plain | {"stages": []}, "form"),
    }
