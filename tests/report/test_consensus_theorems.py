"""The page of wrong pairs names the theorems that it rests on, and says what its pictures are."""

from __future__ import annotations

import re

import numpy as np
import pytest
from wrong_pairs import wrong_pairs

import certreg
from certreg.report.pair_page import PairsReport


@pytest.fixture(scope="module")
def page() -> str:
    pairs = wrong_pairs(np.random.default_rng(2), 12, 0.25)
    result = certreg.certify(pairs.source, pairs.target, max_residual=pairs.bounds)
    return PairsReport.of(result).html().decode()


@pytest.mark.parametrize(
    "words",
    [
        "Two pairs within their bounds have nearly the same length",
        "Many pairs within their bounds are many neighbours",
        "Neighbours with few colours",
        "Weights that refute pairs together",
        "The rotation of every motion within the bounds",
        "residuals at the pose over bounds, from the smallest to the largest",
        "the target as rings, the source at the pose as dots, by label",
        "pairs within their bounds: the witness, tested in integers.",
    ],
)
def test_theorems_and_pictures_are_named(words, page):
    assert words in re.sub(r"\s+", " ", page)
