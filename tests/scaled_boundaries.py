"""What the checker must say of wrong pairs with a free scale just inside and outside of its limits.

Cases as those of `checker_boundaries`, and all vectors of the kind. Lengths and sums are integers
of which the right answer is plain.
"""

from __future__ import annotations

import copy
import json
import random
from functools import cache
from itertools import permutations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from checker_boundaries import Case, outcome_of, value_of

if TYPE_CHECKING:
    from collections.abc import Iterator

VECTORS = Path(__file__).parent.parent / "vectors"


def document_of(name: str) -> dict[str, Any]:
    return json.loads((VECTORS / f"accept-scaled-pairs{name}.json").read_bytes())


def vector_cases() -> Iterator[Case]:
    """Each refused one for its own reason."""
    reasons = {
        "label": "claims.labels: that of row",
        "states": "claims.states is wrong",
        "upper": "claims.upper is below",
        "scale-lower": "claims.scale_lower is not proved",
        "scale-upper": "claims.scale_upper is not proved",
        "reach": "reach is not proved",
        "witness-of-scale-0": "the witness has no scale > 0",
        "witness-of-another": "the witness meets",
        "piece-from-0": "the ends of the pieces do not increase",
        "pieces-": "the ends of the pieces do not increase",
        "piece-last": "the last piece has an end, or there are too many",
        "piece-with-an-end-true": "an end of a piece is no dyadic",
    }
    for path in sorted(VECTORS.glob("*-scaled-pairs*.json")):
        said = path.stem.removeprefix("refuse-scaled-pairs-")
        reason = next((words for name, words in reasons.items() if said.startswith(name)), "")
        answer = "VERIFIED" if path.name.startswith("accept") else f"REFUSED: {reason}"
        yield Case(path.stem, outcome_of(path.read_bytes()), answer)


def number_cases() -> Iterator[Case]:
    """Roots beside each other; parabolas in the scale beside 0."""
    for A, B, d, answer in (
        (49, 9, 4, False),
        (50, 9, 4, True),
        (48, 9, 4, False),
        (9, 49, 4, False),
        (1, 0, 0, True),
        (0, 0, 0, False),
        (16, 0, 4, False),
        (17, 0, 4, True),
    ):
        ask = value_of(lambda checker, p=(A, B, d): checker.longer(*p))
        yield Case(f"longer {A} {B} {d}", ask, f"{answer}$")
    for x, c, level, low, high, answer in (
        (1, 100, 9, 1, 20, True),  # between: the root of 100 is 10
        (1, 100, 10, 1, 20, False),
        (1, 100, 9, 1, None, True),
        (1, 100, 10, 1, None, False),
        (1, 100, 10, 0, 5, True),  # up to 5: 25 + 100 > 10 l
        (1, 100, 12, 0, 5, True),
        (1, 100, 13, 0, 5, False),
        (1, 100, 12, 20, 40, True),
        (1, 100, 12, 20, None, True),  # from 20 on: 400 + 100 > 40 l
        (1, 100, 13, 20, None, False),
        (1, 100, 9, 10, 10, True),
        (1, 100, 10, 10, 10, False),
        (0, 5, 0, 0, None, True),  # a source that is one point
        (0, 5, 0, 0, 7, True),
        (0, 0, 0, 0, None, False),
        (0, -1, 0, 3, 7, False),
        (1, 0, 0, 0, 5, False),  # at the scale 0 all is met
        (1, 0, 1, 3, 5, True),
        (1, 0, 2, 3, 5, False),
        (1, -5, 0, 3, 5, True),
        (1, -5, 0, 2, 5, False),
    ):
        K = [[k * level * (i == j) for j in range(4)] for i, k in enumerate((1, 0, 0, -1))]
        ask = value_of(lambda checker, p=(x, c, K, low, high): checker.scaled_refuted(*p))
        yield Case(f"refuted {x} {c} {level} {low} {high}", ask, f"{answer}$")


def piece_cases() -> Iterator[Case]:
    """Two rows: 10 and 40 apart, the bounds together 20: scales from 2 to 6."""
    rows = [[0, 0, 0, 0, 0, 0, 1, 10], [0, 10, 0, 40, 0, 0, 1, 10]]
    for low, high, answer in (
        (1, 1, True),
        (1, 3, False),
        (0, 1, True),
        (0, 2, False),
        (7, 9, True),
        (6, 9, False),
        (5, 9, False),
        (7, None, True),
        (5, None, False),
    ):

        def ask(checker: Any, low: int = low, high: Any = high) -> str:
            thin = checker.ScaledThinning([], [], 0, 3, [9], low=low, high=high)
            return repr((thin.refuted(rows, [1, 1]), thin.rigid))

        yield Case(f"refuted from {low} to {high}", ask, rf"\({answer}, False\)$")
    yield from counted_cases()
    none = document_of("-without-stages")
    for upper, answer in (
        (8, "VERIFIED"),
        (7, "REFUSED: claims.upper is below the proved bound 8$"),
    ):
        found = none | {"claims": none["claims"] | {"upper": upper}}
        yield Case(f"upper {upper} of no stages", outcome_of(found), answer)
    some = document_of("-open")
    found = some | {"claims": some["claims"] | {"states": "-??=?"}}
    told = r"VERIFIED.*from 1\.75 to 2\.\nNot proved: .* from 2\.25 on\.\nWith any other"
    yield Case("two ranges that are open", outcome_of(found), told)


def counted_cases() -> Iterator[Case]:
    """A row that is lifted off a line, at the scale 1; a group of two of the others, twice.

    1 + (2 - 1) + 2 colours < K = 5; for K = 4 three go together without the group.
    """
    rows = [[0, 0, 0, 0, 30, 0, 1, 10]]
    rows += [[k, 0, 0, k, 0, 0, 1, 10] for k in (-900, 900, -800, 800)]
    near = [31 & ~(1 << i) for i in range(5)]
    for K, answer in ((5, "0$"), (4, "REFUSED: row 0 is not struck$")):

        def ask(checker: Any, K: int = K) -> str:
            thin = checker.ScaledThinning(rows, [*near], 31, K, [999], low=1, high=1)
            try:
                return repr(thin.after([[0, *[[[1, 2], [2, 1, 1]]] * 2]]))
            except checker.RefusalError as error:
                return f"REFUSED: {error}"

        yield Case(f"a group at a scale, K = {K}", ask, answer)


def graph_cases() -> Iterator[Case]:
    """Three rows on a line: lengths 10 and 10 of the source, of the target 40 and 8, d = 2."""
    rows = [
        [0, 0, 0, 0, 0, 0, 1, 1],
        [10, 0, 0, 0, 40, 0, 1, 1],
        [0, 0, 10, 0, 0, -8, 1, 1],
    ]  # scales 3.8 to 4.2, 0.6 to 1
    fine = [[*r[:3], *[10 * k for k in r[3:6]], r[6], 10 * r[7]] for r in rows]
    for ends, answer in (
        ([], r"\[\[6, 5, 3\]\]"),
        ([5], r"\[\[0, 0, 0\], \[6, "),
        ([43], r"\[\[6, .*\], \[0, "),
    ):
        ask = value_of(lambda checker, e=ends: [*checker.graphs(fine, e)])
        yield Case(f"graphs {ends}", ask, answer)

    def edges(checker: Any) -> list[str]:
        """In which of the pieces of all tenths the first row goes with each of the others."""
        pieces = [*checker.graphs(fine, [*range(1, 50)])]
        where = [[k for k, near in enumerate(pieces) if near[0] >> j & 1] for j in (1, 2)]
        return [f"{some[0]}-{some[-1]}:{len(some)}" for some in where]

    yield Case("ranges of two pairs", value_of(edges), r"\['37-42:6', '5-10:6'\]$")

    def differing(checker: Any) -> list[int]:
        return [k for k, (r, e) in enumerate(clouds) if [*checker.graphs(r, e)] != pieces(r, e)]

    clouds = [*small_clouds(400)]
    yield Case("graphs by their definition", value_of(differing), r"\[\]$")
    scaled = value_of(lambda checker: checker.scaled([[1, 2, 3, 4, 5, 6, 7, 8]], 10, 100))
    yield Case("scaled rows", scaled, r"\[\[10, 20, 30, 400, 500, 600, 7, 800\]\]$")


def small_clouds(count: int) -> Iterator[tuple[list[list[int]], list[int]]]:
    """Three rows of small numbers, of which many lengths are as long as they may be, and ends."""
    rng = random.Random(8)
    for _ in range(count):
        size = rng.choice((2, 5, 12, 40))
        rows = [
            [
                *(rng.choice((0, 1, 1)) * rng.randint(-size, size) for _ in range(6)),
                1,
                rng.randint(0, size // rng.choice((1, 2, 4))),
            ]
            for _ in range(3)
        ]
        yield rows, sorted({rng.randint(1, 3 * size) for _ in range(rng.randint(0, 9))})


def pieces(rows: list[list[int]], ends: list[int]) -> list[list[int]]:
    """Of each piece the neighbours of each row: |b - s a| <= d for a scale s of it."""

    def reaches(A: int, B: int, d: int) -> bool:  # sqrt(A) <= sqrt(B) + d
        rest = A - B - d * d
        return rest <= 0 or rest * rest <= 4 * d * d * B

    found = []
    for low, high in zip([0, *ends], [*ends, None], strict=True):
        near = [0] * len(rows)
        for i, j in permutations(range(len(rows)), 2):
            one, other = rows[i], rows[j]
            A, B = (sum((one[k] - other[k]) ** 2 for k in at) for at in ((0, 1, 2), (3, 4, 5)))
            d = one[7] + other[7]
            up = high is None or reaches(B, high * high * A, d)
            near[i] |= (up and reaches(low * low * A, B, d)) << j
        found.append(near)
    return found


def size_cases() -> Iterator[Case]:
    """Pieces times rows squared, bits of ends."""
    good = document_of("-without-stages")
    for name, value, answer in (
        ("GRAPHS_MAX", 64, "VERIFIED"),
        ("GRAPHS_MAX", 63, "REFUSED: the last piece has an end, or there are too many$"),
        ("SCALE_BITS", 8, "VERIFIED"),
        ("SCALE_BITS", 7, "REFUSED: an end of a piece has more than 7 bits$"),
        ("ENDS_BITS", 64, "VERIFIED"),  # of eight pairs
        ("ENDS_BITS", 63, "REFUSED: an end of a piece has more than 7 bits$"),
    ):
        found = copy.deepcopy(good)
        if name != "GRAPHS_MAX":
            found["pieces"] = [[[1, -7], []], [None, []]]
            found["claims"]["states"] = "??"
        yield Case(f"sizes {name} {value}", outcome_of(found, **{name: value}), answer)


def word_cases() -> Iterator[Case]:
    told = {
        "": r"VERIFIED\nData: n = 8 pairs.*\nBounds: .*\nThe clouds .*"
        r"\nOne motion with a scale, 2, rounded up here, brings "
        r"6 of the 8 pairs within their bounds\.\nNo motion with a scale brings more than 6 "
        r"within, whatever the scale\.\nEvery motion with a scale that brings 6 within brings "
        r"these 6 within, and only these\.\nIn EVERY motion with a scale that brings 6 within: "
        r"outliers: "
        r"2, inliers: 6\.\nEvery motion that brings these 6 within has a scale from 1\.\d+ to "
        r"2\.\d+\."
        r"\nEvery motion that brings these 6 within has its rotation within [0-9.e+]+ degrees of "
        r"R, that of the pose below\.\nOf the least squares over these 6 pairs:\n",
        "-open": r"(?s)VERIFIED.*\nNot proved: which 6 pairs or more are met with a scale from "
        r"1\.875 to 2\.\nWith any other scale: these 6 and only these, where 6 or more are met\."
        r"\nNot proved: which of the other 2 pairs are\.\n",
        "-claims-less": r"(?s)VERIFIED.*more than 7 within.*with a scale from 1\.75 on\.\nWith any "
        r"other.*\nNot proved: which of the other 6 pairs are\.",
    }
    for name, answer in told.items():
        content = (VECTORS / f"accept-scaled-pairs{name}.json").read_bytes()
        yield Case(f"words{name}", outcome_of(content), answer)


@cache
def scaled_cases() -> list[Case]:
    parts = (vector_cases, number_cases, piece_cases, graph_cases, size_cases, word_cases)
    return [case for part in parts for case in part()]
