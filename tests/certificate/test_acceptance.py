"""A few of the problems of which `make rates NAME=spring_certificates` takes many."""

import pytest
import spring_families as families

from benchmarks.rates.spring_certificates import BARELY, WELL, Rate, rate_of


@pytest.mark.one_in(4)
@pytest.mark.parametrize("cell", [c for c in families.CELLS if c.n < 20], ids=str)
def test_the_first_problem_of_each_small_cell_is_certified_unique(cell):
    rate = rate_of(cell, 1)

    assert rate.good, str(rate)


def test_a_cell_is_missed_by_one_problem_in_five_hundred_that_is_not():
    cell = families.CELLS[0]

    def rate(*, unique=500, refused=0, angle=WELL, of=cell):
        return Rate(
            cell=of,
            count=500,
            unique=unique,
            refused=refused,
            angle=angle,
            milliseconds=1.0,
            kinds={},
        )

    assert rate().good
    assert rate(unique=499).good
    assert not rate(unique=498).good
    assert not rate(refused=1).good
    assert rate(angle=BARELY).good  # of seven planes
    assert not rate(angle=2 * BARELY).good
    assert not rate(angle=BARELY, of=families.Cell("plane", 8, 0.1)).good
    assert str(rate(unique=498)).startswith("MISSED plane N=7")
