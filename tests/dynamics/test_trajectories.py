"""A trajectory file says whose it is, and NumPy alone reads what it says."""

from __future__ import annotations

import io

import numpy as np

from certreg.dynamics.trajectory import Record
from certreg.registration.examples import STORIES, stated
from certreg.registration.simulation import simulate


def test_a_trajectory_comes_back_as_it_was_written():
    problem = stated(STORIES[0])
    record = Record.of(problem, simulate(problem, "splitting"))
    with np.load(io.BytesIO(record.to_bytes()), allow_pickle=False) as arrays:
        back = dict(arrays)

    digest = bytes(back.pop("digest")).hex()
    assert digest == record.digest == problem.digest() != stated(STORIES[1]).digest()
    assert sorted(back) == [
        "damping",
        "kinetic",
        "length_exponent",
        "potential",
        "states",
        "times",
    ]
    for name, array in back.items():
        assert np.array_equal(getattr(record, name), array)
