"""Long work tells how far it is, to whoever asks; what it returns is the same."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest

import certreg
from certreg.dynamics import batch
from certreg.equilibrium import batch as solutions
from certreg.equilibrium.methods import FINDERS
from certreg.objective.structure import Structure

RNG = np.random.default_rng(29)
SOURCE = RNG.normal(size=(6, 3))
TARGETS = SOURCE + 0.1 * RNG.normal(size=(20, 6, 3))
PROBLEM = certreg.RegistrationProblem(SOURCE, TARGETS[0])


class Heard(list[tuple[int, int]]):
    """What a callback was told."""

    def __call__(self, done: int, total: int) -> None:
        self.append((done, total))


@pytest.mark.parametrize(
    ("methods", "parts"),
    [
        ({"relaxation": True, "simulation": True}, 5),
        ({"relaxation": True, "simulation": False}, 4),
        ({"relaxation": False, "simulation": "euler"}, 4),
        ({"relaxation": False, "simulation": False}, 3),
    ],
)
def test_certify_tells_every_part_and_names_it_in_the_log(
    logged, methods: dict[str, Any], parts: int
):
    heard = Heard()
    with logged(logging.DEBUG) as messages:
        certreg.certify(PROBLEM, progress=heard, **methods)
    named = [one for one in messages if one.endswith(": done")]

    assert heard == [(k + 1, parts) for k in range(parts)]
    assert named[0] == "exact sums: done"
    assert named[-2:] == ["certificate: done", "checker: done"]
    assert len(named) == parts


def test_equilibria_tell_every_search():
    one, all_ = Heard(), Heard()
    certreg.equilibria(PROBLEM, progress=one)
    certreg.equilibria(PROBLEM, "all", progress=all_)

    assert one == [(1, 1)]
    count = len(FINDERS[Structure.LINEAR])
    assert all_ == [(k + 1, count) for k in range(count)]


@pytest.mark.parametrize("threads", [1, 3])
def test_many_problems_tell_every_portion(monkeypatch: pytest.MonkeyPatch, threads: int):
    monkeypatch.setattr(solutions, "PORTION", 8)
    heard = Heard()
    found = certreg.solve_many(SOURCE, TARGETS, threads=threads, progress=heard)
    silent = certreg.solve_many(SOURCE, TARGETS)

    assert heard == [(8, 20), (16, 20), (20, 20)]
    assert np.array_equal(found.quaternions, silent.quaternions)


def test_many_simulations_tell_every_portion_and_end_where_they_did(
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.setattr(batch, "PORTION", 8)
    bodies = certreg.bodies_of(SOURCE, TARGETS)
    heard = Heard()
    told = certreg.simulate_many(bodies, progress=heard)
    silent = certreg.simulate_many(bodies)

    assert heard == [(8, 20), (16, 20), (20, 20)]
    for name in ("status", "steps", "escapes", "times", "states"):
        assert np.array_equal(getattr(told, name), getattr(silent, name)), name
