"""Hard instances as users meet them: some here, 280 in `make hard`."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hard_instances import FAMILIES, outcome

from certreg.registration import DONE, NOT_CERTIFIED
from certreg.results import Optimality


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__)
def test_what_is_certified_ends_so_and_the_simulation_converges(family):
    found = outcome(family, 0)

    assert found.sound
    assert found.converged
    assert found.status is not Optimality.NOT_CERTIFIED


def test_a_code_that_is_not_that_of_the_proof_is_seen():
    found = outcome(FAMILIES[1], 0)

    assert found.code == DONE
    assert not replace(found, code=NOT_CERTIFIED).sound
    assert not replace(found, converged=False, why="").sound
