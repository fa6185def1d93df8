"""Lines that say what is proved: said where it is, and where it is not another line or none."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import pytest

from certreg.dynamics.body import SimulationStatus
from certreg.registration.result import Method
from certreg.report import lines, pairs
from certreg.report.lines import MEANS, UNMET
from certreg.results import Limits

BOTH = (False, True)


def test_a_run_is_said_to_be_proved_in_the_basin_where_its_certificate_claims_that():
    trajectory: Any = SimpleNamespace(
        scales=None,
        steps=3,
        escapes=0,
        energy_left=None,
        converged=False,
        status=SimulationStatus.OUT_OF_STEPS,
        notes=(),
    )
    for basin in (None, False, True, "no certificate"):
        certificate = SimpleNamespace(body=SimpleNamespace(claims=SimpleNamespace(basin=basin)))
        own = None if basin == "no certificate" else certificate
        registration: Any = SimpleNamespace(solution=SimpleNamespace(certificate=own))

        told = lines._motion_lines(registration, trajectory, "1 degrees from the optimum")
        assert any("proved in the basin" in line for line in told) == (basin is True)


@pytest.mark.parametrize("unique", [None, False, True])
def test_an_angle_is_to_the_optimum_of_springs_where_one_rotation_is_proved_to_be(unique):
    registration: Any = SimpleNamespace(
        bounds=SimpleNamespace(
            greatest_gap=Fraction(1, 2), least_range_squared=0, angle_upper=0.125
        ),
        method=Method.ENERGY,
        problem=SimpleNamespace(springs=SimpleNamespace()),
        robustness=None,
        solution=SimpleNamespace(unique_rotation=unique),
    )
    which = "the optimum" if unique else "every optimum"

    told = [
        line
        for line in lines.proved_lines(registration, registration.bounds)
        if "proved angle" in line
    ]
    assert len(told) == 1
    assert told[0].endswith(f" degrees of {which}")


def test_what_certified_means_is_told_of_what_is_certified():
    """And of labels that are all proved what is asked for beside; of open ones neither is."""
    for labelled, certified, given in product(BOTH, BOTH, BOTH):
        if certified and not labelled:
            continue
        limits = Limits(max_gap=0.25) if given else Limits()
        result: Any = SimpleNamespace(
            labels_unique=labelled,
            certified=certified,
            unique=False,
            fit=SimpleNamespace(limits=limits),
        )
        result.least = result

        begins = [line[: len(MEANS)] for line in pairs.limit_words(result)]
        unmet = labelled and not certified
        assert begins == ([UNMET[: len(MEANS)]] if unmet else [MEANS] * (certified and given))
