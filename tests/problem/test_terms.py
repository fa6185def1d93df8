"""One weight per pair is a fast way to what springs that are matrices give: both are equal."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from certreg.objective.by_structure import objective_of
from certreg.objective.isotropic import Isotropic
from certreg.problem.problem import RegistrationProblem

POINT = np.array([1.0, 0.0, 1.0, 0.0, 0.0, 1.0])  # L = I


@settings(max_examples=20)
@given(
    seed=st.integers(0, 10**6),
    n=st.sampled_from([1, 3, 20, 600]),
    rotation_only=st.booleans(),
)
def test_a_weight_is_a_spring_of_its_root_times_the_unit_matrix(
    seed: int, n: int, *, rotation_only: bool
):
    rng = np.random.default_rng(seed)
    source, target = rng.standard_normal((2, n, 3))
    roots = rng.integers(1, 9, n).astype(float)  # squares are doubles
    weighed = RegistrationProblem(
        source, target, weights=roots * roots, rotation_only=rotation_only
    )
    sprung = RegistrationProblem(
        source, target, factors=roots[:, None] * POINT, rotation_only=rotation_only
    )
    fast = Isotropic.of(weighed).joint_form
    general = objective_of(sprung).joint_form

    for z in rng.integers(-9, 10, (20, 13)).tolist():
        assert fast.energy(z) == general.energy(z)


def test_pairs_are_cut_into_rows_whatever_their_springs_are():
    source, target = np.arange(24.0).reshape(2, 4, 3)
    weighed = RegistrationProblem(source, target, weights=[1.0, 2.0, 3.0, 4.0])
    sprung = RegistrationProblem(source, target, factors=np.tile(POINT, (4, 1)))
    for pairs in (weighed.points, sprung.points):
        some = pairs.rows(slice(1, 3))

        assert [len(array) for array in some.arrays] == [2, 2, 2]
        assert some.springs.tolist() == pairs.springs[1:3].tolist()


def test_a_pair_of_another_weight_is_another_energy():
    source, target = np.random.default_rng(0).standard_normal((2, 5, 3))
    one, other = (
        Isotropic.of(RegistrationProblem(source, target, weights=[w, 1, 1, 1, 1])).joint_form
        for w in (1.0, 1.5)
    )

    assert one.energy([1] * 13) != other.energy([1] * 13)
