"""What is told of a known case is what is known of it: counts, angles, shares, names, and when.

C = diag(18, 8, 2): half turns about the axes cost 2 (8 + 2), 2 (18 + 2) and 2 (18 + 8), times two.
"""

from __future__ import annotations

import base64
import gzip
import math
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from strategies import AXES, LINE, SQUARE, TALL, TETRAHEDRON, random_problem

from certreg.certificate.isotropic import RotationState
from certreg.errors import CertregError
from certreg.problem.problem import RegistrationProblem
from certreg.registration.agreement import Agreement
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.report import lines, scene_words, words
from certreg.report.equilibria import count_words
from certreg.report.judged_pose import assessment_summary
from certreg.report.lines import margin_words
from certreg.report.pose_facts import aligned
from certreg.report.reload import report_of
from certreg.report.summary import registration_summary
from certreg.report.thinning import Run, _packed
from certreg.report.viewer import _pairs, packed, sample_of, viewer_words
from certreg.results import Absent, Guarantee

if TYPE_CHECKING:
    from certreg.registration.result import Registration


MIRRORED = (TALL, [[2.0 * x for x in row] for row in TETRAHEDRON])  # patterns 2 1 1 and 3 1
NOISY = random_problem(np.random.default_rng(7), n=9, noise=0.2)


def plainly(source: Any, target: Any, **options: Any) -> Registration:
    problem = RegistrationProblem(source, target, **options)
    return certify(problem, relaxation=False, simulation=False)


def rows(told: str) -> dict[str, str]:
    """The lines of a summary by their names."""
    return {line[2:20].strip(): line[20:] for line in told.splitlines() if line.startswith("  ")}


@pytest.fixture(scope="module")
def axes() -> Registration:
    return plainly(AXES, AXES)


@pytest.fixture(scope="module")
def square() -> Registration:
    """Of rank two with d1 = d2: four rotations with one best, two on a circle, one worst."""
    return plainly(SQUARE, SQUARE)


@pytest.fixture(scope="module")
def whole() -> Registration:
    return certify(NOISY)


def test_the_rows_of_a_summary_hold_the_numbers_of_their_names(whole: Registration):
    told = rows(registration_summary(whole))
    fit, margin = whole.fit, whole.equilibria.margin
    percent = float(told["explained"].split(" %")[0])

    assert told["correspondences"] == "9"
    assert told["rotation (wxyz)"].split() == [repr(float(q)) for q in whole.pose.quaternion_wxyz]
    assert told["translation"].split() == [repr(float(t)) for t in whole.pose.translation]
    assert told["RMSE"].startswith(f"{whole.rmse:.6f}  ")
    assert percent == pytest.approx(100.0 * checked(fit.explained), abs=0.1)
    assert told["ambiguity margin"].startswith(f"{100.0 * margin.relative:.3g} % of the range")
    assert "left out" not in "".join(told.values())
    trajectory: Any = whole.solution.trajectory
    assert told["simulation"].startswith(f"{trajectory.steps} steps, ")
    assert "in the basin" in told["simulation"]


def test_a_method_that_was_left_out_says_why_and_one_not_asked_for_says_nothing(
    whole: Registration,
):
    reason = Absent("too stiff")
    solution = replace(whole.solution, trajectory=reason, relaxation=Absent("no solver"))
    told = rows(registration_summary(replace(whole, solution=solution)))

    assert told["simulation"] == "left out: too stiff"
    assert told["relaxation (SDP)"] == "left out: no solver"
    bare = registration_summary(certify(NOISY, relaxation=False, simulation=False))
    assert "left out" not in bare


@pytest.mark.parametrize(
    ("cloud", "said"),
    [
        (AXES, "exactly four equilibria: the optimum and three spurious ones"),
        (SQUARE, "one optimum and infinitely many spurious equilibria"),
        (TETRAHEDRON, "one optimum and infinitely many spurious equilibria"),
        (LINE, "infinitely many optima and infinitely many spurious equilibria"),
        ([[1.0, 2, 3]] * 4, "every rotation is an equilibrium, and every one is optimal"),
        (MIRRORED[0], "infinitely many optima and exactly two spurious equilibria"),
        (MIRRORED[1], "infinitely many optima and exactly one spurious equilibrium"),
    ],
)
def test_equilibria_are_counted_and_exactly_is_said_of_what_is_exact(cloud: Any, said: str):
    target = -np.array(cloud) if cloud in MIRRORED else cloud
    equilibria = plainly(cloud, target).equilibria
    computed = replace(equilibria, guarantee=Guarantee.NUMERICAL)

    assert count_words(equilibria) == f"Equilibria (exact, complete): {said}."
    assert count_words(computed) == (
        f"Equilibria (numerical, complete): {said.replace('exactly ', '')}."
    )


def test_a_margin_is_said_to_be_small_where_it_is(axes: Registration, square: Registration):
    line = plainly(LINE, LINE)
    near = np.array(SQUARE) * [1.0, 1.0, 0.0]
    mirrored = plainly(np.vstack([near, [[0, 0, 1.0]]]), np.vstack([near, [[0, 0, -1.0]]]))

    assert margin_words(axes.equilibria) == "38.5 % of the range of energies: unique"
    assert margin_words(line.equilibria) == "0: the optimum is not unique"
    for found in (axes, square, mirrored):
        said = "may turn the answer over" in margin_words(found.equilibria)
        assert said == found.equilibria.nearly_ambiguous


@pytest.mark.parametrize(("sigma", "warned"), [(1.26, False), (1.27, True)])
def test_five_deviations_are_of_the_difference_of_the_energies(sigma: float, *, warned: bool):
    """The next equilibrium costs 4 (8 + 2) over sigma^2: 25 of it at sigma = 1.2649."""
    told = lines.warnings(plainly(AXES, AXES, sigma=sigma), "")

    assert any("do not rule out the next equilibrium" in note for note in told) == warned


def test_an_assessment_is_told_with_its_own_numbers():
    found = assess(RegistrationProblem(AXES, AXES), [0.8, 0.6, 0.0, 0.0], np.zeros(3))
    energies = checked(found.energies)
    bounds = replace(energies.bounds, least_gap=Fraction(0), greatest_gap=Fraction(1, 3))
    bounds = replace(bounds, angle_upper=math.radians(25.0))
    given = replace(
        found,
        angle_to_optimum=math.radians(20.0),
        energies=replace(
            energies,
            objective=Fraction(12),
            optimum=Fraction(3),
            mean_square=Fraction(4),
            least_square=Fraction(1),
            bounds=bounds,
            rounding_cost=Fraction(2, 3),
        ),
    )
    told = assessment_summary(given).splitlines()

    numbers = {line[2:21].strip(): line[21:].split("  (")[0] for line in told if line[:2] == "  "}
    assert [numbers[name] for name in ("RMSE", "objective", "above the minimum")] == [
        *("2.000000", "12.000000", "at most 0.334 (proved)"),
    ]
    assert numbers["angle to optimum"] == "20 degrees, within 25.1 (proved)"
    assert numbers["rounding can cost"] == "0.667"
    assert "  of the optimum     1.000000\n" in assessment_summary(given)
    assert "  of the optimum     3.000000\n" in assessment_summary(given)
    for wide in (None, math.pi):
        open_ = replace(checked(given.energies), bounds=replace(bounds, angle_upper=wide))
        assert "20 degrees\n" in assessment_summary(replace(given, energies=open_))


def test_no_bound_is_said_to_bound_nothing_where_there_is_none(axes: Registration):
    span = Fraction(104)

    assert not lines.bounds_nothing(replace(axes, bounds=None), 2 * span)
    assert not lines.bounds_nothing(axes, span / 2)
    assert lines.bounds_nothing(axes, 2 * span)


def test_the_sentences_of_a_page_hold_the_numbers_of_the_certificate(axes: Registration):
    body = checked(axes.certificate).body
    state = RotationState(quaternion=(1000, 1, 0, 0), angular_velocity=(3, 4, 0, -3))
    claims = replace(body.claims, basin=True)
    given = replace(body, claims=claims, basin=state)
    told = [one.words for one in words.sentences(axes, given)]
    degrees = math.degrees(2 * math.atan(1e-3))

    assert told[2].startswith("There are exactly four equilibria: the optimum and three spurious ")
    assert told[2].endswith(". The list is complete.")
    assert " spurious ones: " in told[2]
    assert told[3].startswith("In this order they have 0, 1, 2, 3 growing modes: ")
    (basin,) = [one for one in told if one.startswith("From the state in the certificate")]
    within = float(basin.split("within ")[1].split("°")[0])
    assert degrees <= within <= 1.1 * degrees
    assert "turning by at most 0.63 radians per unit of time" in basin  # 5 / 8
    assert not any(
        "growing" in one.words
        for one in words.sentences(axes, replace(given, claims=replace(claims, unstable=None)))
    )


def test_of_two_components_the_growing_modes_are_told():
    cube = np.array([[a, b, c] for a in (1.0, -1) for b in (1.0, -1) for c in (1.0, -1)])
    found = plainly(cube.tolist(), cube.tolist())
    told = [one.words for one in words.sentences(found, checked(found.certificate).body)]

    assert found.equilibria.classification.pattern == (1, 3)
    assert any(one.startswith("In this order they have 0, 1 growing modes: ") for one in told)


def test_where_all_poses_are_optimal_no_mode_is_said_to_grow():
    point, line = plainly(AXES, [[0.0, 0, 0]] * 6), plainly(LINE, LINE)
    assert point.equilibria.classification.unstable == (0,)
    for found in (point, line):
        told = [one.words for one in words.sentences(found, checked(found.certificate).body)]
        assert not any("growing modes" in one for one in told)


def test_a_road_that_ends_apart_is_named_with_its_angle(axes: Registration):
    angles = Agreement(closed_form=0.0, relaxation=math.radians(12.5), simulation=None)
    told = words.methods_sentence(axes, angles).words

    assert told == (
        "Independent roads lead to the same rotation: the closed form to 0°. "
        "The semidefinite relaxation does not: it ended 12.5° from it. No proof rests on it."
    )


def test_the_worst_pose_and_every_button_are_told_with_their_angles():
    problem = random_problem(np.random.default_rng(2), n=8, noise=0.3)
    found = certify(problem, relaxation=False, simulation=False)
    components = found.equilibria.components
    rests = viewer_words(found)["rests"]
    trap = checked(scene_words.trap_words(found.equilibria))

    assert [one["badge"] for one in rests] == [f"index {k}" for k in range(4)]
    assert [one["name"] for one in rests] == ["Optimum", "Saddle", "Saddle", "Worst rotation"]
    for rest, component in zip(rests[1:], components[1:], strict=True):
        away = math.degrees(component.angle_to_optimum)
        times = checked(component.rmse) / checked(components[0].rmse)
        assert rest["notes"] == [
            f"RMSE {component.rmse:.6f}",
            f"{times:.3g} times the optimum's",
            f"{away:.4g}° from the optimum",
        ]
    assert trap.startswith(f"The worst rotation, {away:.4g}° off, balances the springs, too. ")
    assert f"({times:.3g} times the optimum's), and unstable: a push" in trap


def test_a_pose_at_rest_is_told_by_what_it_is(axes: Registration, square: Registration):
    told = [scene_words.component_words(axes.equilibria, k) for k in range(4)]

    assert told[0] == (
        "No pose fits better. Turned a little about any axis, the energy rises, and the body comes "
        "back."
    )
    assert "the fit is not the best: RMSE 2.581989. Turning about one axis lowers" in told[1]
    assert "and so 1 of the 12 eigenvalues has a positive real part: along its mode a" in told[1]
    assert "2 of the 12 eigenvalues have a positive real part: along their modes a" in told[2]
    assert [("worst rotation there is" in one) for one in told] == [False, False, False, True]
    flat = [scene_words.component_words(square.equilibria, k) for k in range(3)]
    assert flat[0].startswith("No pose fits better.")
    line = plainly(LINE, LINE).equilibria
    assert scene_words.component_words(line, 0).startswith(
        "No pose is better than these, and all of"
    )
    assert scene_words.component_name(line, 0).startswith("Optima: ")
    assert scene_words.component_name(square.equilibria, 1).startswith("Saddles: ")


def test_what_a_weak_certificate_proves_is_told_with_its_numbers(axes: Registration):
    bounds = replace(checked(axes.bounds), greatest_gap=Fraction(1, 3), angle_upper=0.1)

    told = words.weak_words(replace(axes, bounds=bounds))
    assert "by at most 0.334, and its rotation is within 5.73 degrees" in told
    assert "by at most an unknown amount, and of its angle" in words.weak_words(
        replace(axes, bounds=None)
    )


def test_what_the_script_reads_is_what_was_computed():
    values = np.array([1.5, -2.0, 1e300, -1e300])
    run = Run(
        start=3,
        times=np.array([0.0, 1.0]),
        quaternions=np.eye(4)[:2],
        offsets=np.zeros((2, 3)),
        potential=np.array([5.0, 4.0]),
        kinetic=np.array([0.0, 0.5]),
        length_exponent=-2,
        last=9.0,
        end=np.eye(4)[0],
        converged=True,
        left=0.0,
        escapes=0,
    )
    most = float(np.finfo(np.float32).max)

    def floats(text: str) -> list[float]:
        return np.frombuffer(base64.b64decode(text), "<f4").tolist()

    assert floats(_packed(values)) == [1.5, -2.0, most, -most]
    fields = run.fields
    assert (fields["start"], fields["length_exponent"], fields["last"]) == (3, -2, 9.0)
    assert floats(fields["times"]) == [0.0, 1.0]
    assert floats(fields["potential"]) == [5.0, 4.0]
    assert floats(fields["kinetic"]) == [0.0, 0.5]
    assert floats(fields["quaternions"]) == np.eye(4)[:2].ravel().tolist()
    assert gzip.decompress(base64.b64decode(packed(b"abc" * 99))) == b"abc" * 99
    sample = np.frombuffer(base64.b64decode(sample_of(NOISY)), "<f8")
    assert sample.tolist() == [
        *NOISY.source.ravel().tolist(),
        *NOISY.target.ravel().tolist(),
        *NOISY.weights.tolist(),
    ]
    assert _pairs(np.array([1 - 2j, 3j])) == [[1.0, -2.0], [0.0, 3.0]]
    assert _pairs(np.array([np.inf + 0j])) is _pairs(None) is None


def test_what_is_no_certificate_is_named_with_its_file(tmp_path: Path):
    path = tmp_path / "wrong.json"
    path.write_text("{}", "utf-8")
    with pytest.raises(CertregError, match=r"wrong\.json"):
        report_of(path)
    count = next((Path(__file__).parents[2] / "vectors").glob("accept-*count*.json"))
    with pytest.raises(CertregError, match=rf"^{re.escape(str(count))}: .*: give the certificate"):
        report_of(count)


def test_the_rows_of_a_matrix_stand_in_columns():
    rows = aligned([[1.0, -0.5, 0.0, 12345.5], [0.0, 1.0, -1.0, -2.0], [0.5, 0.5, 0.5, 0.0]])

    assert len({len(row) for row in rows}) == 1
    assert [row.split() for row in rows] == [
        ["1.000000", "-0.500000", "0.000000", "12345.5"],
        ["0.000000", "1.000000", "-1.000000", "-2"],
        ["0.500000", "0.500000", "0.500000", "0"],
        ["0", "0", "0", "1"],
    ]
