"""How far the points of general springs may move: no such move turns the optimum further."""

import json
import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import spring_families as families
from scipy.spatial.transform import Rotation

from certreg.certificate.cones import springs_certificate
from certreg.certificate.envelope import Certificate
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.optimum import find_optimum
from certreg.verify import Movable, RefusalError, check

CELLS = [
    families.Cell("plane", 20, 0.05),
    families.Cell("line", 10, 0.05),
    families.Cell("aniso", 10, 0.1),
    families.Cell("mixed", 20, 0.1),
]


def optimum_of(problem):
    objective = Springs.of(problem)
    return objective, find_optimum(objective)


def certificate_of(made, degrees) -> Any:
    problem = RegistrationProblem(**families.statement(made))
    return springs_certificate(problem, *optimum_of(problem), robustness_angle=degrees)


def turn(p, q):
    first, second = (Rotation.from_quat(np.array(k, float), scalar_first=True) for k in (p, q))
    return math.degrees((first.inv() * second).magnitude())


@pytest.mark.parametrize("unit", [1.0, 1e-20, 1e-60, 1e-100])
def test_springs_that_fit_exactly_have_a_radius_in_every_unit(unit: float):
    """The checker takes 2^-70 for the root of an energy of 0, which is much in a small unit."""
    rng = np.random.default_rng(0)
    points, normals = unit * rng.normal(size=(8, 3)), rng.normal(size=(8, 3))
    problem = RegistrationProblem(points, points, normals=normals)
    certificate: Any = springs_certificate(problem, *optimum_of(problem), robustness_angle=5.0)

    assert check(certificate.to_json()).verified
    assert certificate.body.radius.both.mantissa > 0


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("cell", CELLS, ids=str)
def test_no_move_within_the_radius_turns_the_optimum_further(cell):
    made = families.instance(cell, 0)
    certificate = certificate_of(made, 5.0)
    assert check(certificate.to_json()).verified
    rng, radius = np.random.default_rng(0), certificate.body.radius
    centred = (made.source - made.source.mean(axis=0)) @ made.rotation.T
    for axis in np.eye(3):
        for off in (np.cross(axis, centred), rng.standard_normal(centred.shape)):
            unit = off / np.linalg.norm(off, axis=1, keepdims=True)
            for x, y in ((0.0, float(radius.target.value)), 2 * (float(radius.both.value),)):
                disturbed = replace(
                    made,
                    source=made.source - 0.999 * x * unit @ made.rotation,
                    target=made.target + 0.999 * y * unit,
                )
                moved = RegistrationProblem(**families.statement(disturbed))
                assert turn(certificate.body.quaternion, optimum_of(moved)[1].quaternion) < 5.0


@pytest.mark.parametrize("name", ["target", "both"])
def test_claims_a_little_larger_are_refused(name):
    certificate = certificate_of(families.instance(CELLS[0], 1), 30.0)
    document = json.loads(certificate.to_json())
    assert check(certificate.to_json()).verified
    assert Certificate.load(certificate.to_json()) == certificate
    mantissa, exponent = document["radius"][name]
    document["radius"][name] = [mantissa + (mantissa >> 16) + 1, exponent]

    assert check(json.dumps(document).encode()).reason == "radius is larger than what is proved"


def claimed(target: Fraction, both: Fraction) -> Movable:
    return Movable(both=both, separation=None, sin_half_angle=Fraction(1, 2), target=target)


def told_by(target: Fraction, both: Fraction, numbers: tuple[Fraction, ...]) -> list[str] | str:
    """What the checker says of a claim, or why it refuses it."""
    try:
        return claimed(target, both).steady_by_growth(*numbers)
    except RefusalError as error:
        return str(error)


TIMES = pytest.mark.parametrize(("times", "proved"), [(1 - 2**-40, True), (1 + 2**-40, False)])


@TIMES
def test_the_bound_is_the_stated_one(times, proved):
    """Weight 4, lever 9, f = 25, mu = 10, delta = 1/2, s = 1/2, so (5 - 24 r)/2 >= 1/2.

    For both clouds ((10 - 48 r)/2 - 4 (12 r + 2 r (5 + 4 r)))/2 >= 1/2, so 32 r^2 + 112 r <= 4.
    """
    numbers = (Fraction(10), Fraction(1, 2), Fraction(25), Fraction(4), Fraction(9))
    both = Fraction((math.sqrt(112**2 + 512) - 112) / 64)
    for target, other in (
        (Fraction(times) / 6, both / 2),
        (Fraction(1, 12), both * Fraction(times)),
    ):
        told = told_by(target, other, numbers)
        assert proved is isinstance(told, list)
        assert proved or told == "radius is larger than what is proved"


@TIMES
def test_so_is_the_bound_by_roots(times, proved):
    """Weight 1, lever 81, f = 9/16, mu = 14, delta = 1, s = 1/2: 7/2 >= 1 + 4 m (3/4 + m).

    So m = X + Y <= 1/2; by slopes less than a sixth of that.
    """
    numbers = (Fraction(14), Fraction(1), Fraction(9, 16), Fraction(1), Fraction(81))
    for target, other in ((Fraction(times) / 2, Fraction(1, 8)), (Fraction(1, 4), times / 4)):
        told = told_by(target, Fraction(other), numbers)
        assert proved is isinstance(told, list)
        assert proved or told == "radius is larger than what is proved"
