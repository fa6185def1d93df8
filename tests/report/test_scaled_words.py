"""What is said where the scale is free, or there is no translation, word for word."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import certreg
from certreg.errors import InvalidProblemError, OutOfRangeError
from certreg.registration.units import unit_words

RNG = np.random.default_rng(3)
SOURCE = RNG.normal(size=(9, 3))
TARGET = 2.0 * SOURCE[:, [1, 2, 0]] + 0.01 * RNG.normal(size=(9, 3))
BIAS = {
    "asymmetric": "noise in the source makes it too small; noise in the target does not",
    "symmetric": "right where both clouds have the same relative noise, too large with noise in "
    "the target alone",
}


def stated(**options: Any):
    return certreg.RegistrationProblem(SOURCE, TARGET, **options)


def certified(**options: Any) -> Any:
    return certreg.certify(stated(**options), relaxation=False, simulation=False)


@pytest.mark.parametrize("scale", list(BIAS))
def test_the_text_says_which_scale_it_is_and_what_noise_does_to_it(scale: str):
    told = certified(scale=scale).summary()

    assert f"({scale}; target over source)" in told
    assert BIAS[scale] in told
    assert "meanwhile the scale stays between" in told


MODELS = [{"scale": "asymmetric"}, {"scale": "symmetric"}, {"rotation_only": True}]


@pytest.mark.parametrize("options", MODELS)
def test_text_and_json_say_which_tests_of_the_fit_there_are_not(options: dict[str, Any]):
    found, rigid = certified(**options), certified()
    words = (
        "not tested for wrong rows, another order of the rows, or a mirror image: only fits of "
        "scale 1 with a translation are"
    )

    assert f"\n                    {words}\n" in found.summary()
    assert found.to_dict()["reasons"]["fit.warnings"] == words
    assert rigid.fit.untested is None
    assert words not in rigid.summary()
    assert "fit.warnings" not in rigid.to_dict()["reasons"]


def test_clouds_that_do_not_correspond_have_the_scale_0_in_words():
    point = certreg.RegistrationProblem(SOURCE, [[1.0, 2.0, 3.0]] * 9, scale="asymmetric")
    told = certreg.certify(point, relaxation=False, simulation=False).summary()

    assert (
        "0: the clouds do not correspond (the cross-covariance is zero), so that the best fit is "
        "one point" in told
    )


def test_a_scale_that_no_double_holds_is_refused():
    apart = certreg.RegistrationProblem(SOURCE * 1e-200, TARGET * 1e150, scale="symmetric")

    with pytest.raises(OutOfRangeError) as error:
        certreg.certify(apart)
    assert str(error.value) == (
        "the scale exceeds the range of doubles: change the unit of length of one cloud"
    )


def test_units_are_named_in_words():
    told = {ratio: unit_words(Fraction(ratio), Fraction(1), 5) for ratio in (1e6, 2.54, 12.0)}

    assert told == {
        1e6: "1000000.0 times: a unit? (micrometres against metres)",
        2.54: "2.54 times: a unit? (centimetres against inches)",
        12.0: "12.0 times: a unit? (inches against feet)",
    }


def test_a_pose_with_a_translation_is_refused_beside_rotations_alone():
    with pytest.raises(InvalidProblemError) as error:
        certreg.assess(stated(rotation_only=True), (np.eye(3), [1.0, 2.0, 3.0]))

    assert str(error.value) == (
        "the problem is of rotations alone, and the pose has the translation [1.0, 2.0, 3.0]: "
        "give its rotation, or state the problem without rotation_only (--rotation-only)"
    )


def test_what_a_pose_costs_is_told_apart():
    problem, best = stated(scale="asymmetric"), certified(scale="asymmetric").pose
    near = replace(best, scale=1.2 * best.scale)
    told = certreg.assess(problem, near).summary()

    assert "Of what it costs above the minimum, " in told
    assert "from the scale, under 0.1 % from the rotation, " in told


def test_json_has_the_parts_of_a_gap_and_the_scale_of_the_optimum():
    problem, best = stated(scale="asymmetric"), certified(scale="asymmetric").pose
    found = certreg.assess(problem, replace(best, scale=1.2 * best.scale))
    told = found.to_dict()
    parts = found.gap_parts

    assert parts is not None
    assert list(told["gap_parts"]) == ["scale", "rotation", "translation"]
    for name, cost in told["gap_parts"].items():
        exact = getattr(parts, name)
        assert exact <= Fraction(cost) <= exact * (1 + Fraction(1, 2**52))
    assert sum(told["gap_parts"].values()) >= told["gap_lower"] > 0
    assert told["optimum"]["scale"] == best.scale


def test_json_says_why_a_rigid_problem_or_no_rotation_has_neither():
    planes = certreg.RegistrationProblem(SOURCE, SOURCE, normals=np.eye(3).repeat(3, axis=0))
    for problem in (stated(), planes):
        told = certreg.assess(problem, np.eye(3)).to_dict()
        assert told["gap_parts"] is told["optimum"]["scale"] is None
        assert told["reasons"]["gap_parts"] == "the scale is not free"
        assert told["reasons"]["optimum.scale"] == "the scale was not asked for"
    told = certreg.assess(stated(scale="asymmetric"), np.diag([1.0, 1.0, -1.0])).to_dict()
    assert told["verdict"] == "not-a-rotation"
    assert told["gap_parts"] is None
    assert told["reasons"]["gap_parts"] == told["words"]


def test_there_is_no_relaxation_of_a_free_scale():
    reasons = certreg.certify(stated(scale="asymmetric")).to_dict()["reasons"]

    assert reasons["relaxation"] == "the relaxation is of scale 1, not of a free one"


def test_why_a_problem_of_scale_1_has_no_parts_of_a_gap():
    reasons = certreg.assess(stated(), np.eye(3)).absent

    assert reasons["gap_parts"].reason == "the scale is not free"


def test_no_slip_is_tried_where_the_scale_is_free():
    told = certreg.assess(stated(scale="asymmetric"), np.eye(4)).to_dict()["reasons"]

    assert told["slip"] == "no slip is tried where the scale is free"
    assert told["fit.scale_p"] == (
        "with a free scale, or without a translation, no rows and no scale are tested"
    )


def test_what_is_not_computed_of_a_free_scale_says_why():
    found = certreg.certify(stated(scale="asymmetric"))

    assert found.to_dict()["reasons"]["relaxation"] == (
        "the relaxation is of scale 1, not of a free one"
    )
