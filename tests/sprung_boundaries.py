"""What the checker must say of wrong pairs whose least squares are of general springs.

Cases as those of `checker_boundaries`; the vectors of the kind are asked by `consensus_boundaries`.
"""

from __future__ import annotations

import struct
from base64 import b64decode
from functools import cache
from typing import TYPE_CHECKING, Any

import certificates as oracle
import numpy as np
from checker_boundaries import Case, outcome_of, value_of
from consensus_boundaries import Document, document_of, vector

if TYPE_CHECKING:
    from collections.abc import Iterator

PREFIX = b"certreg-consensus-springs/1\0"
NAME = "accept-consensus-springs"
WIDTH = 13  # doubles a pair: two points, a bound, six entries of a factor


def numbers_of(document: Document) -> list[list[float]]:
    """Source, target, and what follows, of the data of a certificate."""
    n, data = document["problem"]["n"], b64decode(document["problem"]["data"])
    assert data.startswith(PREFIX)
    numbers = np.frombuffer(data[len(PREFIX) + 8 :]).tolist()
    assert len(numbers) == WIDTH * n
    return [numbers[: 3 * n], numbers[3 * n : 6 * n], numbers[6 * n :]]


def stated(document: Document, numbers: list[float]) -> Document:
    """The certificate of other numbers."""
    n = document["problem"]["n"]
    content = PREFIX + struct.pack(f"<Q{len(numbers)}d", n, *numbers)
    return document | {"problem": oracle.stated_problem(content, n)}


def row_cases() -> Iterator[Case]:
    """Rows of distinct integers: each is in its place."""
    n = 3
    content = struct.pack(f"<{WIDTH * n}d", *range(1, WIDTH * n + 1))
    rows = [
        [*(3 * j + k for j in (i, n + i) for k in (1, 2, 3)), 6 * n + i + 1]
        + [7 * n + 6 * i + k for k in range(1, 7)]
        for i in range(n)
    ]

    def places(checker: Any) -> bool:
        found, e = checker.sprung_rows(content, n)
        weights = {row.pop(6) for row in found}
        return weights == {1} and [[k * 2.0**e for k in row] for row in found] == rows

    yield Case("rows of springs", value_of(places), "True")


def factor_cases() -> Iterator[Case]:
    """Another number in the factor of a pair: of one that is met it is another fit."""
    good = document_of(NAME)
    points, (n, met) = numbers_of(good), (12, 9)
    for row in (0, met - 1, met, n - 1):
        for place in range(6):
            own = [*points[2]]
            own[n + 6 * row + place] += 1.0
            found = stated(good, [*points[0], *points[1], *own])
            answer = "REFUSED: fit is refused: the digest" if row < met else "VERIFIED"
            yield Case(f"factor {row} {place}", outcome_of(found), answer)
    for row, bound, answer in (
        (0, 0.0, "REFUSED: row 0 has a bound <= 0 or"),
        (3, 0.1875, "REFUSED: a stage is misplaced"),
        (met, 0.1875, "VERIFIED"),
    ):
        own = [*points[2]]
        own[row] = bound
        found = stated(good, [*points[0], *points[1], *own]) | {"fit": None}
        without = {key: value for key, value in found.items() if key != "reach"}
        yield Case(f"bound {bound} of {row}", outcome_of(without), answer)
    gap = [good["fit"]["claims"]["gap"][0] - 1, good["fit"]["claims"]["gap"][1]]
    claims = good["fit"]["claims"] | {"gap": gap}
    less = good | {"fit": good["fit"] | {"claims": claims}}
    yield Case("a smaller gap", outcome_of(less), "REFUSED: fit is refused: claims.gap is not pro")
    spoilt = [*points[2]]
    spoilt[n] = 2.0**-800
    sizes = stated(good, [*points[0], *points[1], *spoilt])
    yield Case("sizes of factors", outcome_of(sizes), "REFUSED: the data hold numbers of too many")
    kinds = {
        "accept-springs-cones": "VERIFIED",
        "accept-springs-list": "REFUSED: fit is of another",
    }
    for name, answer in kinds.items():
        fit = document_of(name) | {"problem": good["fit"]["problem"]}
        found = {key: value for key, value in good.items() if key != "reach"} | {"fit": fit}
        yield Case(f"fit: {name}", outcome_of(found), answer)


def said_cases() -> Iterator[Case]:
    """The key itself: true, false or missing."""
    good, plain = document_of(NAME), document_of("accept-consensus")
    for value, answer in ((False, "VERIFIED"), (None, "VERIFIED"), (True, "REFUSED: data is not")):
        yield Case(f"springs {value} of weights", outcome_of(plain | {"springs": value}), answer)
    missing = {key: value for key, value in good.items() if key != "springs"}
    yield Case("springs not said", outcome_of(missing), "REFUSED: data is not of n points")


def word_cases() -> Iterator[Case]:
    answer = (
        r"VERIFIED\nData: n = 12 pairs, each with a bound and a spring\. SHA-256 of their doubles "
        r"is \S+\.\nA bound is on the distance of the two points of a pair, whatever its spring\."
        r"\nBounds: .*\nThe clouds .*"
        r"\nOne rigid motion brings 9 of the 12 pairs within their bounds\.\n(.*\n)*"
        r"Every motion that brings these 9 within has its rotation within \S+ degrees of R, "
        r"that of the pose below\.\nOf the least squares over these 9 pairs:\n"
        r"Data: n = 9 pairs, each with a matrix W of springs\."
    )
    yield Case("words of springs", outcome_of(vector(NAME).encode()), answer)


def cloud_cases() -> Iterator[Case]:
    """Points, bounds and factors that are given beside."""
    good = document_of(NAME)
    parts = numbers_of(good)
    without = good | {"problem": good["problem"] | {"data": None}}
    others = [*parts[2][:-1], parts[2][-1] + 1]
    hint = r"REFUSED: the certified bounds or springs are others, or not given: .* and springs$"
    for name, document, own, model, answer in (
        ("given", good, parts[2], "--max-residual", "VERIFIED"),
        ("given alone", without, parts[2], "--max-residual", "VERIFIED"),
        ("not given", good, None, "--max-residual", hint),
        ("others", good, others, "--max-residual", hint),
        ("others alone", without, others, "--max-residual", "REFUSED: the digest"),
        ("bounds alone", good, parts[2][:12], "--max-residual", "REFUSED: the certificate is abou"),
        ("of no bounds", good, parts[2], "", "REFUSED: the certificate has --max-residual: give"),
    ):

        def asked(checker: Any, of: Document = document, own: Any = own, model: str = model) -> str:
            rest = None if own is None else tuple(own)
            clouds = checker.Clouds(tuple(parts[0]), tuple(parts[1]), rest, model)
            return outcome_of(of, clouds)(checker)

        yield Case(f"clouds with springs {name}", asked, answer)


@cache
def sprung_cases() -> list[Case]:
    parts = (row_cases, factor_cases, said_cases, word_cases, cloud_cases)
    return [case for part in parts for case in part()]
