from __future__ import annotations

import json
import math
import pickle
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import strategies
from commands import checked
from hypothesis import given
from rotations import turned

import certreg
from certreg import RegistrationProblem
from certreg.certificate import envelope, isotropic
from certreg.certificate.blockwise import check_in_blocks
from certreg.certificate.bounds import (
    ExactPose,
    flat_energy,
    pose_bounds,
    pose_energy,
    sin2_half_angle_between,
)
from certreg.certificate.checking import CertificateVerdict, check_own
from certreg.certificate.count import count_certificate
from certreg.certificate.isotropic import produce, proves_optimality
from certreg.equilibrium.critical_set import by_eigenspaces
from certreg.errors import InvalidFileError, InvalidProblemError
from certreg.exact.elimination import is_positive_definite
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.registration.optimum import optimal_pose
from certreg.results import Guarantee, Optimality, Ruling, Verdict
from certreg.verify import check


def certificate_of(problem):
    return produce(problem, Isotropic(exact_moments(problem)))


def certified(problem):
    """Without the two slow methods: they have tests of their own."""
    return certreg.certify(problem, relaxation=False, simulation=False)


def squared_distances(problem, pose):
    w = problem.weights[:, None]
    return float((w * (problem.target - pose.apply(problem.source)) ** 2).sum())


@pytest.mark.slow
@given(strategies.problems())
def test_every_problem_is_certified_with_the_claims_of_its_row(problem):
    registration = certified(problem)
    certificate, classification = registration.certificate, registration.equilibria.classification

    assert certificate is not None
    assert registration.verdict is not None
    assert registration.verdict.ruling is Ruling.PROVED
    assert certificate.body.claims.pattern == classification.pattern
    assert certificate.body.claims.unstable == classification.unstable
    assert certificate.body.claims.unique == (classification.pattern[0] == 1)
    assert (certificate.body.claims.sin2_half_angle is None) == (not classification.unique)
    unique = registration.status is Optimality.CERTIFIED
    assert unique == classification.unique


def test_an_about_of_any_keys_is_kept_and_the_points_are_where_they_belong():
    problem = strategies.random_problem(np.random.default_rng(1))
    about = {"data": None, "problem": {"data": None}, "damping": 7.0, "integrator": "mine"}
    registration = certreg.certify(problem, relaxation=False, simulation=False, about=about)
    content = checked(registration.certificate).to_json()
    kept = json.loads(content)["about"]

    assert check(content).verified
    assert kept == {**about, "damping": registration.problem.damping, "integrator": None}


@pytest.mark.slow
@pytest.mark.parametrize(
    "part", [0, *(pytest.param(k, marks=pytest.mark.long) for k in range(1, 32))]
)
def test_two_thousand_random_problems_are_verified_with_small_proven_angles(part):
    rng = np.random.default_rng(1000 + part)
    for _ in range(64):
        problem = strategies.random_problem(
            rng,
            n=round(10 ** rng.uniform(math.log10(3), 4 if rng.random() < 0.03 else 2.5)),
            noise=float(rng.choice([0.0, 1e-6, 0.01, 0.1, 1.0, 10.0])),
            offset=float(rng.choice([0.0, 1.0, 1e4, 1e8])),
            scale=10.0 ** float(rng.choice([-100, -50, -3, 0, 3, 50, 100])),
            decades=float(rng.choice([0, 4, 16])),
        )
        angle, margin = proven_angle(problem)
        assert angle is not None
        if margin >= 1e-6:
            assert angle <= 1e-10


def proven_angle(problem):
    """The bound on the angle of the pose that is told, and the margin (l1 - l2) / (l1 - l4).

    As `certify` does it, which this test would mostly spend on all that it says besides.
    """
    objective = Isotropic(exact_moments(problem))
    certificate = produce(problem, objective)
    assert certificate is not None
    assert certificate.body.claims.unique
    assert check_own(certificate, problem).proved
    pose = optimal_pose(objective)
    place = ExactPose.of_doubles(pose.quaternion_wxyz, pose.translation)
    best, second, *_, worst = [part.value for part in by_eigenspaces(objective).components]
    angle = pose_bounds(objective, certificate.body, place).angle_upper
    return angle, (second - best) / (worst - best)


def test_certify_tells_the_angle_and_the_margin_of_the_thousands():
    problem = strategies.random_problem(np.random.default_rng(2), noise=1.0)
    registration = certified(problem)

    assert registration.status is Optimality.CERTIFIED
    assert registration.bounds is not None
    angle, margin = proven_angle(problem)
    assert angle == registration.bounds.angle_upper
    assert float(margin) == registration.equilibria.margin.relative


@pytest.mark.parametrize("margin", [1e-6, 1e-8, 1e-12, 1e-15, 1e-40])
def test_the_proven_angle_is_honest_at_every_margin(margin):
    """C = diag(18, 2 + 2 margin, -2) in a turned frame, so that rounding is at work."""
    source = np.vstack([strategies.AXES, [[0.0, 0, 0]]])
    target = source * [1, 1, -1]
    target[2:4, 1] *= 0.25 * (1 + margin)
    problem = RegistrationProblem(source, target)
    registration = certified(problem)
    bounds = registration.bounds

    assert bounds is not None
    if registration.equilibria.classification.unique:
        assert bounds.angle_upper is not None
        assert bounds.angle_upper < 1e-10
    else:
        assert registration.status is Optimality.CERTIFIED_NOT_UNIQUE
        assert bounds.angle_upper is None


@pytest.mark.slow
def test_no_random_rotation_does_better_than_the_certified_minimum():
    rng = np.random.default_rng(6)
    problem = strategies.random_problem(rng, noise=1.0)
    registration = certified(problem)
    w = problem.weights[:, None]
    x = problem.source - (w * problem.source).sum(0) / w.sum()
    y = problem.target - (w * problem.target).sum(0) / w.sum()
    optimum = registration.pose.rotation
    assert registration.objective is not None
    for k in range(2000):
        R = strategies.random_rotation(rng)
        if k % 2:  # near the optimum
            R = turned(optimum, rng.normal(size=3) * 10.0 ** rng.uniform(-4, -1))
        assert (w * (y - x @ R.T) ** 2).sum() > registration.objective * (1 - 1e-9)


def test_a_quaternion_beside_the_optimum_is_not_proved_optimal():
    problem = strategies.random_problem(np.random.default_rng(0))
    moments = exact_moments(problem)
    certificate = certificate_of(problem)
    assert certificate is not None
    q, mu, delta = (
        certificate.body.quaternion,
        certificate.body.mu.value,
        certificate.body.delta.value,
    )
    beside = (q[0] + (q[0] >> 40), *q[1:])

    assert proves_optimality(Isotropic(moments), q, mu, delta)
    assert not proves_optimality(Isotropic(moments), beside, mu, delta)
    assert not proves_optimality(Isotropic(moments), q, mu, delta / 2**40)
    assert not proves_optimality(Isotropic(moments), q, 3 * mu, delta)


@pytest.mark.parametrize("along", [1, 2, 3, 5])
def test_leading_bits_tell_only_what_the_whole_matrix_is(along):
    """Of 2^s B + E, B = [J, 0; 0, J] large and `along` more on the diagonal, E cuts 2 2^s of it.

    J is of ones: along (1, -1, 1, -1) all that B has is `along`, and E takes nearly 2 2^s, so that
    1 is too little. The bits prove it from 5 on, which is more than four: up to there they are
    silent, and never tell what is false.
    """
    signs, large, s = (1, -1, 1, -1), 2 ** (isotropic.LEADING_BITS - 1), 50
    rows = [
        [
            ((large * (i // 2 == j // 2) + along * (i == j)) << s)
            + (2**s - 1) * (signs[i] != signs[j])
            for j in range(4)
        ]
        for i in range(4)
    ]

    assert is_positive_definite(rows) == (along > 1)
    assert isotropic._bits_tell(rows, isotropic.LEADING_BITS) == (along > 4)
    least = [[4 * (i == j) for j in range(4)] for i in range(4)]
    assert not isotropic._bits_tell(least, isotropic.LEADING_BITS)


@pytest.mark.parametrize("index", [1, 2, 3])
def test_a_spurious_equilibrium_is_never_proved_optimal(index):
    problem = strategies.random_problem(np.random.default_rng(1))
    found = Isotropic(exact_moments(problem))
    certificate = certificate_of(problem)
    assert certificate is not None

    q = found.quaternions[index]
    for mu in (certificate.body.mu.value, Fraction(0)):
        assert not proves_optimality(found, q, mu, certificate.body.delta.value)


@pytest.mark.slow
@given(strategies.problems())
def test_bounds_on_the_reported_pose_hold_for_its_exact_energy(problem):
    registration = certified(problem)
    certificate, bounds = registration.certificate, registration.bounds
    assert certificate is not None
    assert bounds is not None
    pose, moments = registration.pose, registration.solution.moments
    exact = ExactPose.of_doubles(pose.quaternion_wxyz, pose.translation)
    energy = pose_energy(Isotropic(moments), exact)

    assert bounds.gap_lower <= bounds.gap_upper
    if registration.objective is not None and registration.objective > 1e-290:
        assert registration.objective == pytest.approx(float(energy), rel=1e-15)


def test_bounds_bracket_the_energy_of_any_pose_above_the_minimum():
    rng = np.random.default_rng(3)
    problem = strategies.random_problem(rng, noise=0.5)
    registration = certified(problem)
    assert registration.certificate is not None
    minimum = squared_distances(problem, registration.pose)
    for component in registration.equilibria.components[1:]:
        bounds = pose_bounds(
            registration.solution.objective,
            registration.certificate.body,
            ExactPose.of_doubles(component.quaternion_wxyz, registration.pose.translation),
        )
        shift = registration.pose.translation
        moved = problem.source @ component.rotation.T + shift
        direct = float((problem.weights[:, None] * (problem.target - moved) ** 2).sum())
        assert bounds.gap_lower == pytest.approx(direct - minimum, rel=1e-10)
        assert bounds.gap_lower <= bounds.gap_upper
        assert bounds.angle_upper == pytest.approx(math.pi)
        assert bounds.angle_upper is not None
        assert bounds.angle_upper <= math.pi  # no angle is larger: a sum of bounds may be


@pytest.mark.parametrize(
    ("pattern", "words"),
    [((1, 1, 1, 1), "though the optimum is unique"), ((2, 2), "the optimum is not unique")],
)
def test_why_an_angle_is_missing_depends_on_whether_the_optimum_is_unique(pattern, words):
    problem = next(each.problem for each in strategies.ZOO if each.pattern == pattern)
    objective = Isotropic(exact_moments(problem))
    body = checked(produce(problem, objective)).body
    silent = replace(body, claims=replace(body.claims, sin2_half_angle=None))
    bounds = pose_bounds(
        objective, silent, ExactPose(quaternion=(1, 0, 0, 0), translation=(Fraction(0),) * 3)
    )

    assert bounds.angle_upper is None
    assert words in bounds.stated("angle_upper").reason


def test_two_clouds_that_are_a_point_each_are_measured_from_the_origin():
    source, target = [[1.0, 2.0, 2.0]] * 3, [[0.0, 3.0, 4.0]] * 3
    moments = exact_moments(RegistrationProblem(source, target, weights=[1.0, 2.0, 4.0]))

    assert moments.spread == 0
    assert flat_energy(moments) == 7 * (9 + 25)


def test_the_sine_between_quaternions_is_exact():
    assert sin2_half_angle_between((1, 0, 0, 0), (0, 0, 5, 0)) == 1
    assert sin2_half_angle_between((1, 0, 0, 0), (3, 0, 0, 0)) == 0
    assert sin2_half_angle_between((1, 0, 0, 0), (1, 1, 0, 0)) == Fraction(1, 2)


def test_a_certificate_is_saved_and_verified_from_its_file(tmp_path):
    problem = strategies.random_problem(np.random.default_rng(0))
    certificate = certified(problem).certificate
    assert certificate is not None
    path = tmp_path / "certificate.json"
    certificate.save(path)

    assert certreg.verify(path).proved
    assert certreg.verify(path, problem).proved
    assert certreg.verify(path.read_bytes()).proved
    assert [p.name for p in tmp_path.iterdir()] == ["certificate.json"]
    assert json.loads(path.read_bytes())["format"] == "certreg-certificate/1"


def test_bounds_that_are_asked_for_are_compared_with_those_proved():
    problem = strategies.random_problem(np.random.default_rng(0))
    certificate = certificate_of(problem)
    assert certificate is not None
    content = certificate.to_json()
    worth = certreg.verify(content).worth
    assert worth is not None
    assert worth.angle is not None

    less = 1 - Fraction(1, 2**60)
    for kind, name in (("angle", "max_angle"), ("share", "max_gap")):
        bound = getattr(worth, kind)
        for points in (None, problem):
            assert certreg.verify(content, points, **{name: bound}).proved
            refused = certreg.verify(content, points, **{name: bound * less})
            assert (refused.ruling, refused.worth) == (Ruling.REFUTED, None)
        assert check_in_blocks(content, problem, {kind: bound}).verified
        assert not check_in_blocks(content, problem, {kind: bound * less}).verified
        for wrong in (math.nan, math.inf, "1e-5 rad"):
            limit: dict[str, Any] = {name: wrong}
            with pytest.raises(InvalidProblemError, match=r"is .+: give (a number|radians)$"):
                certreg.verify(content, **limit)
    assert check_own(certificate, problem).worth == worth
    count = count_certificate(problem)
    assert count is not None
    assert certreg.verify(count.to_json()).worth is None


def test_what_an_own_certificate_proves_is_written_when_it_is_read_and_goes_into_a_pickle():
    registration = certreg.certify(strategies.random_problem(np.random.default_rng(0)))
    own, told = registration.verdict, certreg.verify(checked(registration.certificate).to_json())
    assert own is not None

    assert own.theorems == told.theorems != ()
    for verdict in (own, told, pickle.loads(pickle.dumps(registration)).verdict):  # noqa: S301
        assert isinstance(verdict, CertificateVerdict)
        assert (verdict.ruling, verdict.words) == (told.ruling, told.words)
        assert (verdict.theorems, verdict.worth) == (told.theorems, told.worth)


def test_a_certificate_of_another_problem_is_refused():
    a = strategies.random_problem(np.random.default_rng(0))
    b = strategies.random_problem(np.random.default_rng(1))
    certificate = certificate_of(a)
    assert certificate is not None

    verdict = certreg.verify(certificate.to_json(), b)
    assert verdict.ruling is Ruling.REFUTED
    assert not check(
        certificate.to_json().replace(a.digest().encode(), b.digest().encode())
    ).verified


def test_a_certificate_without_its_points_needs_them(monkeypatch):
    monkeypatch.setattr(envelope.CertificateBody, "INLINE", 5)
    problem = strategies.random_problem(np.random.default_rng(0))
    certificate = produce(problem, Isotropic(exact_moments(problem)))
    assert certificate is not None
    assert certificate.data is None
    assert not certreg.verify(certificate.to_json()).proved
    assert certreg.verify(certificate.to_json(), problem).proved


def test_a_missing_file_is_an_error_not_a_verdict(tmp_path):
    with pytest.raises(InvalidFileError, match=r"nowhere\.json"):
        certreg.verify(tmp_path / "nowhere.json")


def test_a_verdict_has_no_truth_value():
    with pytest.raises(TypeError, match="three values"):
        bool(Verdict(ruling=Ruling.PROVED, words=""))


def test_guarantees_combine_by_their_minimum():
    assert min(Guarantee.EXACT, Guarantee.ENCLOSED, Guarantee.NUMERICAL) is Guarantee.NUMERICAL


def test_certify_refuses_to_say_certified_if_the_checker_refuses(monkeypatch):
    from certreg.errors import RefusedCertificateError
    from certreg.registration import squares

    refusal = Verdict(ruling=Ruling.REFUTED, words="planted")
    monkeypatch.setattr(squares, "check_own", lambda *_: refusal)

    with pytest.raises(RefusedCertificateError, match="planted"):
        certified(strategies.random_problem(np.random.default_rng(0)))


def test_a_closed_form_that_contradicts_the_certificate_is_not_ignored(monkeypatch):
    from certreg.errors import ContradictionError
    from certreg.registration import agreement

    monkeypatch.setattr(agreement, "arun", lambda _: np.array([0.6, 0.0, 0.8, 0.0]))

    with pytest.raises(ContradictionError, match="Arun"):
        certified(strategies.random_problem(np.random.default_rng(0)))


@pytest.mark.parametrize("converged", [True, False])
def test_a_simulation_that_says_it_arrived_and_did_not_is_not_ignored(converged):
    from certreg.dynamics.body import SimulationStatus
    from certreg.errors import ContradictionError
    from certreg.registration.agreement import agreement

    problem = strategies.random_problem(np.random.default_rng(0))
    solution: Any = certreg.certify(problem, relaxation=False).solution
    status = SimulationStatus.CONVERGED if converged else SimulationStatus.OUT_OF_STEPS
    course = solution.trajectory.course
    last = course.last.copy()
    last["q"] = np.roll(last["q"], 1, axis=-1)
    elsewhere = replace(solution.trajectory, course=replace(course, last=last), status=status)
    parts = {"relaxation": solution.relaxation, "trajectory": elsewhere}
    if converged:
        with pytest.raises(ContradictionError, match="the simulation contradicts"):
            agreement(problem, solution.objective, **parts)
    else:
        assert checked(agreement(problem, solution.objective, **parts).simulation) > 0.1


def test_without_a_certificate_nothing_is_called_certified(monkeypatch):
    from certreg.registration import linear

    monkeypatch.setattr(linear, "produce", lambda *_, **__: None)
    registration = certified(strategies.random_problem(np.random.default_rng(0)))

    assert registration.status is Optimality.NOT_CERTIFIED
    assert registration.bounds is None
    assert registration.verdict is None


# The envelope -----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_a_certificate_that_is_loaded_is_the_one_that_was_saved(specimen, tmp_path):
    whole = certreg.certify(specimen.problem, about={"name": '"data": null'}).certificate
    for certificate in (whole, count_certificate(specimen.problem)):
        if certificate is None:
            continue
        certificate.save(tmp_path / "certificate.json")
        for one in (certificate, replace(certificate, inline=None)):
            loaded = certreg.Certificate.load(one.to_json())
            assert loaded == one
            assert loaded.to_json() == one.to_json()
        assert certreg.Certificate.load(tmp_path / "certificate.json") == certificate


def spoilt(certificate):
    """Files that are no certificates, by what is wrong with them."""
    honest = json.loads(certificate.to_json())
    yield "not JSON", b"{"
    yield "too large", certificate.to_json() + b"," * 100_000
    yield "known kind", json.dumps({**honest, "kind": "springs"}).encode()
    yield "exactly the keys", json.dumps({**honest, "more": 1}).encode()
    yield "right length", json.dumps({**honest, "pose": "q"}).encode()
    problem = {**honest["problem"], "data": "AAA*"}
    yield "base64", json.dumps({**honest, "problem": problem}).encode()


@pytest.mark.parametrize("missing", [(), ("quaternion",), ("angular_velocity",)])
def test_a_state_that_is_null_in_part_is_refused_and_in_whole_is_none(missing):
    """The checker accepts both where nothing is claimed of the state."""
    certificate = certificate_of(strategies.random_problem(np.random.default_rng(0)))
    assert certificate is not None
    fields = json.loads(certificate.to_json())
    state = {"quaternion": [1, 0, 0, 0], "angular_velocity": [0, 0, 0, 0]}
    fields["basin"] = {**state, **dict.fromkeys(missing or state)}
    content = json.dumps(fields).encode()

    assert check(content).verified
    if missing:
        with pytest.raises(InvalidFileError, match=rf"\(basin\.{missing[0]} is not "):
            certreg.Certificate.load(content)
    else:
        loaded = certreg.Certificate.load(content)
        assert loaded.body.to_fields()["basin"] is None
        assert certreg.Certificate.load(loaded.to_json()) == loaded


def test_what_is_no_certificate_is_refused_in_one_line(tmp_path):
    certificate = certificate_of(strategies.random_problem(np.random.default_rng(0)))
    for words, content in spoilt(certificate):
        (tmp_path / "x.json").write_bytes(content)
        for one in (content, tmp_path / "x.json"):
            with pytest.raises(InvalidFileError, match=words) as caught:
                certreg.Certificate.load(one)
            assert "\n" not in str(caught.value)
    with pytest.raises(InvalidFileError, match=r"nowhere\.json"):
        certreg.Certificate.load(tmp_path / "nowhere.json")


@pytest.mark.parametrize("seed", range(3))
def test_the_level_of_the_basin_is_what_the_claims_prove_above_all_other_eigenvalues(
    monkeypatch: pytest.MonkeyPatch, seed: int
):
    """v + delta - mu, in units of tr(R^T C), as the docstring of `isotropic` has it."""
    levels = list[Fraction]()
    monkeypatch.setattr(isotropic, "proves_basin", lambda *given: bool(levels.append(given[2])))
    problem = strategies.random_problem(np.random.default_rng(seed), n=8)
    objective = Isotropic(exact_moments(problem))
    state = isotropic.RotationState(quaternion=(1, 0, 0, 0), angular_velocity=(0, 0, 0, 0))
    body = checked(produce(problem, objective, state=state)).body
    (level,) = levels

    assert level == objective.alignment(body.quaternion) + body.delta.value - body.mu.value
    assert body.delta.value > 0
    assert level > objective.eigenvalues[1]
