"""Roads that lead to the optimum are told with the angle of the one that ended farthest."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest

from certreg.problem import RegistrationProblem
from certreg.registration import certify

AXES = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])])


@pytest.mark.parametrize("off", ["horn", "arun"])
def test_the_closed_form_that_ended_farther_is_told(monkeypatch: pytest.MonkeyPatch, off: str):
    """A turn of 1e-6 about x costs 1e-13 of the range: no contradiction, and told."""
    roads = import_module("certreg.registration.agreement")
    monkeypatch.setattr(roads, off, lambda _: np.array([1.0, 5e-7, 0.0, 0.0]))
    found = certify(RegistrationProblem(AXES, AXES), relaxation=False, simulation=False)

    assert found.solution.agreement.closed_form == pytest.approx(1e-6)
