"""A problem with general springs: its factors, its digest, and what nobody may read by mistake."""

from __future__ import annotations

import copy
import hashlib
import struct

import numpy as np
import pytest
from spring_families import Cell, instance, statement

import certreg
from certreg.errors import InvalidProblemError
from certreg.problem import exact_moments, floating_moments

PLANES = statement(instance(Cell("plane", 7, 0.1), 1))


@pytest.fixture(name="planes", scope="module")
def _planes() -> certreg.RegistrationProblem:
    return certreg.RegistrationProblem(**PLANES)


def test_a_normal_is_the_first_column_of_its_factor(planes: certreg.RegistrationProblem) -> None:
    assert planes.factors is not None
    assert planes.springs is not None

    assert (planes.factors[:, [0, 1, 3]] == PLANES["normals"]).all()
    assert not planes.factors[:, [2, 4, 5]].any()
    assert (planes.springs.kind, planes.springs.ranks) == ("plane", (0, 7, 0, 0))


def test_the_digest_is_of_both_clouds_and_the_factors(planes: certreg.RegistrationProblem) -> None:
    factors = np.zeros((7, 6))
    factors[:, [0, 1, 3]] = PLANES["normals"]
    numbers = [*PLANES["source"].ravel(), *PLANES["target"].ravel(), *factors.ravel()]
    stated = b"certreg-springs/1\0" + struct.pack(f"<Q{len(numbers)}d", 7, *numbers)

    assert planes.data_bytes() == stated
    assert planes.digest() == hashlib.sha256(stated).hexdigest()
    assert copy.deepcopy(planes).digest() == planes.digest()
    assert planes.damped(2.0).digest() == planes.digest()


@pytest.mark.parametrize("read", [exact_moments, floating_moments, lambda p: p.weights])
def test_nobody_takes_springs_for_weights(planes: certreg.RegistrationProblem, read) -> None:
    with pytest.raises(InvalidProblemError, match="a matrix for every pair and not a weight"):
        read(planes)


def test_blocks_of_springs_and_of_weights_are_not_confused(
    planes: certreg.RegistrationProblem,
) -> None:
    weighted = certreg.RegistrationProblem(PLANES["source"], PLANES["target"])

    assert planes.spring_block(slice(2, 5)).factors.shape == (3, 6)
    assert weighted.springs is None
    assert weighted.factors is None
    with pytest.raises(InvalidProblemError, match="not a weight"):
        planes.block(slice(0, 2))
    with pytest.raises(InvalidProblemError, match="one weight for each pair"):
        weighted.spring_block(slice(0, 2))
