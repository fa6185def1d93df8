"""Certificates of a free scale: what the checker accepts is exactly what is proved."""

from __future__ import annotations

import json
from fractions import Fraction
from math import isqrt
from typing import Any

import certificates as oracle
import numpy as np
import pytest

import certreg
from certreg.errors import DegenerateProblemError, InvalidProblemError
from certreg.registration.simulation import optimally_damped
from certreg.verify import Clouds, check

pytestmark = pytest.mark.quick
AXES = oracle.stretched((3, 2, 1))
SCALES = ["asymmetric", "symmetric"]


def cloud_pair(seed, *, noise=0.1, scale=2.5):
    draw = np.random.default_rng(seed)
    source = draw.normal(size=(12, 3))
    turn, _ = np.linalg.qr(draw.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    return source, scale * source @ turn.T + noise * draw.normal(size=(12, 3)) + [1, 2, 3]


def document(scale="asymmetric", *, rotation_only=False, seed=1):
    problem = certreg.RegistrationProblem(
        *cloud_pair(seed), scale=scale, rotation_only=rotation_only
    )
    found: Any = certreg.certify(problem, relaxation=False, simulation=False)
    return json.loads(found.certificate.to_json())


def answer(found):
    outcome = check(json.dumps(found).encode())
    return "VERIFIED" if outcome.verified else outcome.reason


def boundary(scale, name):
    """The proved value of a claim of the octahedron stretched by 3, 2, 1 onto itself, exactly.

    Its Davenport matrix is diag(28, 8, -12, -24): tr(R^T C) = 28 = Sx = Sy at the identity.
    """
    delta = Fraction(1, 2**40)
    asymmetric = {
        "gap": delta * (56 + delta) / 28,
        "scale_lower": Fraction(1),
        "scale_upper": (28 + delta) / 28,
    }
    return (asymmetric if scale == "asymmetric" else {"gap": 2 * delta, **SYMMETRIC})[name]


SYMMETRIC = {"scale_lower": Fraction(1), "scale_upper": Fraction(1)}


def octahedron(scale, **claims):
    problem = certreg.RegistrationProblem(AXES, AXES, scale=scale)
    certified: Any = certreg.certify(
        problem, relaxation=False, simulation=False, robustness_angle=None
    )
    found = json.loads(certified.certificate.to_json())
    found["optimality"], found["pose"] = {"delta": [1, -40], "mu": [8, 0]}, [1, 0, 0, 0]
    found["claims"].update(
        {
            "gap": [1, 0],
            "scale_lower": [0, 0],
            "scale_upper": [2, 0],
            "sin2_half_angle": None,
            **claims,
        }
    )
    return found


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("name", ["gap", "scale_lower", "scale_upper"])
def test_each_bound_is_accepted_just_outside_what_is_proved_and_refused_just_inside(scale, name):
    edge, step = boundary(scale, name), Fraction(1, 2**120)
    down = edge // step  # in units of the step
    up = -(-edge // step)
    weaker, stronger = (down, up + 1) if name == "scale_lower" else (up, down - 1)

    assert answer(octahedron(scale, **{name: [weaker, -120]})) == "VERIFIED"
    assert f"claims.{name.split('_')[0]}" in answer(octahedron(scale, **{name: [stronger, -120]}))


def test_a_negative_alignment_is_refused_though_the_formula_gives_no_gap():
    found = octahedron("asymmetric", gap=[1, -60], scale_lower=[-64, 0], scale_upper=[64, 0])
    found["pose"], found["optimality"] = [0, 0, 0, 1], {"delta": [53, 0], "mu": [0, 0]}
    found["claims"]["pattern"] = [1, 1, 1, 1]

    assert "best scale is 0" in answer(found)  # delta = 53 > 2 |v| = 48: the gap would be positive
    found["optimality"]["delta"] = [48, 0]  # at 2 |v| it would be 0, and below it negative
    assert answer(found) != "VERIFIED"


def test_no_digest_stands_for_two_problems_and_another_model_is_told_in_one_line():
    clouds = cloud_pair(5)
    models = [(s, r) for s in ("none", *SCALES) for r in (False, True)]
    problems = [certreg.RegistrationProblem(*clouds, scale=s, rotation_only=r) for s, r in models]
    assert len({problem.digest() for problem in problems}) == 6

    for problem in problems:
        certified: Any = certreg.certify(problem, relaxation=False, simulation=False)
        found = certified.certificate
        for other in problems:
            verdict = certreg.verify(found, other)
            assert verdict.proved == (other is problem)
            if other is not problem:
                said = problem.motion.options or "neither --scale nor --rotation-only"
                assert verdict.words == f"the certificate has {said}: give the same"


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("scale", SCALES)
def test_forgeries_are_refused(scale):
    """Of each number of the proof and of each claim, made stronger by many factors."""
    good, refused = document(scale, rotation_only=scale == "symmetric"), 0
    assert answer(good) == "VERIFIED"
    other = "symmetric" if scale == "asymmetric" else "asymmetric"
    forged = [{**good, "scale": word} for word in (other, "none", "both", "")]
    forged.append({**good, "rotation_only": not good.get("rotation_only")})
    forged += [
        {**good, "pose": [p + k * (i == j) for j, p in enumerate(good["pose"])]}
        for i in range(4)
        for k in (1 << 80, -(1 << 80), 1 << 90, 1 << 100, -(1 << 100))
    ]
    draw = np.random.default_rng(7)
    for k in range(1, 121):
        less = Fraction(int(draw.integers(1, 2**20)), 2**20)  # of (0, 1)
        for name in ("gap", "sin2_half_angle", "scale_upper", "scale_lower"):
            m, e = good["claims"][name]
            new = (
                [m * 2**k + 2**k, e - k]
                if name == "scale_lower"
                else [int(m * 2**40 * less), e - 40]
            )
            claims = {
                **good["claims"],
                name: [new[0] * (1 + k), new[1]] if name == "scale_lower" else new,
            }
            forged.append({**good, "claims": claims})
        optimality = {**good["optimality"], "delta": [1, -500 - k]}
        forged.append({**good, "optimality": optimality})
    for pattern in ([1, 2, 1], [4], [2, 2], []):
        forged.append({**good, "claims": {**good["claims"], "pattern": pattern}})
    for one in forged:
        refused += answer(one) != "VERIFIED"

    assert refused == len(forged) > 600


def test_symmetric_bounds_of_an_irrational_scale_are_accepted_exactly_up_to_the_root():
    """Of sources of Sx = 28 and targets of Sy = 56 the scale is sqrt(2)."""
    target = (np.array(AXES) * np.sqrt(2.0)).tolist()
    sizes = [
        sum((Fraction(c) ** 2 for row in cloud for c in row), start=Fraction(0))
        for cloud in (target, AXES)
    ]
    ratio = sizes[0] / sizes[1]
    problem = certreg.RegistrationProblem(AXES, target, scale="symmetric")
    certified: Any = certreg.certify(problem, relaxation=False, simulation=False)
    found = json.loads(certified.certificate.to_json())
    root = isqrt((ratio.numerator << 400) // ratio.denominator)
    for name, good in (("scale_lower", root), ("scale_upper", root + 1)):
        bad = 2 * root + 1 - good
        for number, verdict in ((good, True), (bad, False)):
            found["claims"][name] = [number, -200]
            assert (answer(found) == "VERIFIED") == verdict
        found["claims"][name] = [good, -200]


def test_degenerate_clouds_get_their_answer_or_a_clear_refusal():
    point, line = [[1.0, 2, 3]] * 4, [[k, 2 * k, 0.0] for k in range(4)]
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    for scale in SCALES:
        with pytest.raises(DegenerateProblemError, match=r"all source points .* at one point"):
            certreg.certify(certreg.RegistrationProblem(point, corners, scale=scale))
    with pytest.raises(DegenerateProblemError, match=r"all target points .* symmetric scale"):
        certreg.certify(certreg.RegistrationProblem(corners, point, scale="symmetric"))

    nothing: Any = certreg.certify(certreg.RegistrationProblem(corners, point, scale="asymmetric"))
    assert (nothing.pose.scale, nothing.status.value) == (0.0, "certified-not-unique")
    assert "the best fit is one point" in nothing.summary()
    along: Any = certreg.certify(
        certreg.RegistrationProblem(line, 3 * np.array(line), scale="asymmetric")
    )
    assert (along.pose.scale, along.status.value) == (3.0, "certified-not-unique")


def test_what_is_not_of_a_free_scale_says_so():
    source, target = cloud_pair(9)
    with pytest.raises(InvalidProblemError, match="not yet with a free scale"):
        certreg.RegistrationProblem(source, target, normals=source, scale="asymmetric")
    problem = certreg.RegistrationProblem(source, target, scale="symmetric")
    with pytest.raises(InvalidProblemError, match="for one weight per pair and scale 1"):
        optimally_damped(problem)
    with pytest.raises(InvalidProblemError, match="scale is 'free'"):
        certreg.RegistrationProblem(source, target, scale="free")
    bare = Clouds(tuple(source.ravel()), tuple(target.ravel()))
    certified: Any = certreg.certify(problem, relaxation=False, simulation=False)
    assert not check(certified.certificate.to_json(), bare).verified
