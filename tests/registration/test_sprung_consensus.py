"""Wrong pairs with general springs: labels are those of points, the pose is along the springs."""

from __future__ import annotations

import json
from functools import cache
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
from commands import certreg as run
from commands import write_csv
from wrong_pairs import BOUND, WrongPairs, wrong_pairs

import certreg
from certreg.errors import InvalidFileError, InvalidProblemError, RefusedCertificateError
from certreg.geometry.so3 import rotation_matrix
from certreg.report.reload import report_of

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.registration.labelled import ConsensusRegistration


N = 24


def axes(seed: int, n: int = N) -> np.ndarray:
    made = np.random.default_rng([seed, 1]).standard_normal((n, 3))
    return made / np.linalg.norm(made, axis=1)[:, np.newaxis]


def springs(seed: int) -> dict[str, Any]:
    """Planes, lines, covariances, and some of each."""
    normals, others = axes(seed), axes(seed + 100)
    B = np.random.default_rng([seed, 2]).standard_normal((N, 3, 3))
    some, rest = normals.copy(), others.copy()
    some[::2], rest[1::2] = np.nan, np.nan
    kinds: tuple[dict[str, Any], ...] = (
        {"normals": normals},
        {"directions": others},
        {"covariances": B @ B.transpose(0, 2, 1) + 0.1 * np.eye(3)},
        {"normals": some, "directions": rest},
    )
    return kinds[seed % 4]


def pairs(seed: int) -> WrongPairs:
    return wrong_pairs(np.random.default_rng(seed), N, (0.25, 0.5, 0.75)[seed % 3])


def certified(given: WrongPairs, **options: Any) -> ConsensusRegistration:
    found = certreg.certify(given.source, given.target, max_residual=given.bounds, **options)
    return cast("ConsensusRegistration", found)


@cache
def result(seed: int = 0) -> ConsensusRegistration:
    return certified(pairs(seed), **springs(seed))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_every_motion_that_meets_the_pairs_turns_by_less_than_the_reach(seed: int):
    given, found = pairs(seed), result(seed)
    reach = found.certificate.body.reach
    assert reach is not None
    rng, rows = np.random.default_rng(seed), found.inliers
    x, y = given.source[rows], given.target[rows]
    turned = 0.0
    for size in rng.uniform(0.0, 0.2, 800):
        q = found.witness.quaternion_wxyz + size * rng.standard_normal(4)
        q /= np.linalg.norm(q)
        moved = x @ np.array(rotation_matrix(q.tolist())).T
        off = y - moved
        t = (off.min(axis=0) + off.max(axis=0)) / 2.0
        if (np.linalg.norm(off - t, axis=1) <= given.bounds[rows]).all():
            turned = max(turned, 1.0 - float(q @ found.pose.quaternion_wxyz) ** 2)
    assert 0.0 < turned < float(reach.sin2_half_angle.value)


@pytest.mark.slow
def test_what_is_said_names_the_springs_and_what_is_bounded():
    text = str(result())
    count = result().lower
    assert (
        "  springs           planes, of the least squares alone: a bound is on the distance of two "
        "points\n"
    ) in text
    assert f"(of these {count}, along the springs, unit of the clouds)" in text
    assert (
        f"  least squares     of these {count}: CERTIFIED: the global optimum, and unique" in text
    )
    assert "  proved angle      at most " in text
    assert result()._repr_html_()
    assert "24 pairs, each with a bound and a spring" in str(result().verdict)


def wall() -> ConsensusRegistration:
    return certified(pairs(1), normals=np.tile([0.0, 0.0, 1.0], (N, 1)))


@pytest.mark.slow
def test_springs_that_leave_the_pose_undetermined_are_told():
    found = wall()
    assert found.labels_unique
    assert found.exit_code == 3
    assert len(found.broken) > 0
    text = str(found)
    assert text.startswith("CERTIFIED, BUT THE POSE IS NOT UNIQUE: no rigid motion brings more ")
    assert "CERTIFIED, BUT NOT UNIQUE: no pose is better by more than the proved gap, and" in text
    assert "no spring resists a shift along" in text
    assert "add pairs with springs across what is undetermined" in text
    assert "beyond the bound at the least-squares pose, though one\n" in text
    assert "its rotation" in text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("along", "against"), [(0.0, "A SHIFT IS FREE"), (1e-8, "A SHIFT IS HARDLY RESISTED")]
)
def test_a_shift_that_no_spring_resists_is_told_first(along: float, against: str):
    given, normals = pairs(1), axes(1)
    normals[:, 2] = along
    found = certified(given, normals=normals)
    assert found.labels_unique
    assert found.headline.startswith(f"CERTIFIED, BUT {against}: no rigid motion brings more ")


@pytest.mark.slow
def test_few_planes_leave_a_pose_undetermined_to_first_order():
    rng = np.random.default_rng(5)
    source = rng.uniform(size=(9, 3))
    target = source[:, [1, 2, 0]] + rng.uniform(-0.01, 0.01, (9, 3))
    target[4:] = rng.uniform(2.0, 9.0, (5, 3))
    found: Any = certreg.certify(source, target, normals=axes(5, 9), max_residual=0.05)
    assert found.exit_code == 4
    assert found.headline.startswith("CERTIFIED, BUT THE POSE IS NOT CERTIFIED: no rigid motion ")
    assert "the ranks of the springs add up to 4 (a plane 1, a line 2, a full spring 3)" in str(
        found
    ).replace("The ranks", "the ranks")


@pytest.mark.slow
def test_the_page_says_what_the_springs_leave_open(tmp_path: Path):
    for found, words in (
        (
            result(),
            ("Planes, of the least squares alone: a bound is on", "points, bounds and springs"),
        ),
        (wall(), ("Of the least squares: CERTIFIED, BUT NOT UNIQUE", "Add pairs with springs acr")),
    ):
        page = found.report(tmp_path / "report.html")
        text = page.read_text("utf-8")
        for one in words:
            assert one in text
        assert "On springs that break" not in text
        saved = found.save(tmp_path)
        assert saved is not None
        again = report_of(saved).html()
        assert (tmp_path / "report.html").read_bytes() == again


@pytest.mark.slow
def test_a_certificate_that_holds_no_fit_has_no_page(tmp_path: Path):
    document = json.loads(result().certificate.to_json())
    document["fit"] = None
    document.pop("reach")
    place = tmp_path / "bare.json"
    place.write_text(json.dumps(document), "utf-8")
    assert certreg.verify(place).proved
    with pytest.raises(InvalidFileError, match="holds no least squares"):
        report_of(place)
    document["springs"] = False
    place.write_text(json.dumps(document), "utf-8")
    with pytest.raises(RefusedCertificateError, match="data is not of n points"):
        report_of(place)


def test_springs_that_are_all_0_are_refused_in_one_line():
    given = pairs(0)
    factors = np.zeros((N, 6))
    factors[~given.true] = 1.0
    with pytest.raises(
        InvalidProblemError, match=r"of the pairs that were met \(r.*\) all springs are zero"
    ):
        certified(given, factors=factors)


def test_labels_of_another_method_are_judged_by_the_points():
    given = pairs(0)
    asked: dict[str, Any] = {"labels": given.true, "max_residual": given.bounds}
    points: Any = certreg.assess(given.source, given.target, **asked)
    along: Any = certreg.assess(given.source, given.target, **asked, **springs(0))
    assert along.headline == points.headline
    assert along.headline.startswith("CONSISTENT: one rigid motion brings all 18 labelled inliers")


@pytest.mark.slow
def test_what_is_odd_of_the_springs_is_told():
    found = certified(pairs(0), normals=3.0 * axes(0))
    words = "normals: 24 are not of length 1, the first in row 0 (from 0): springs count by its sq"
    assert f"  warning           {words}" in str(found)


@pytest.mark.slow
def test_the_command_certifies_and_the_checker_verifies(tmp_path: Path):
    given = pairs(0)
    source = write_csv(tmp_path / "a.csv", given.source.tolist())
    rows = np.column_stack([given.target, axes(0)])
    target = tmp_path / "b.csv"
    lines = [",".join(map(repr, row)) for row in rows.tolist()]
    target.write_text("x,y,z,nx,ny,nz\n" + "\n".join(lines) + "\n", "utf-8")
    options = ("--springs", "plane", "--max-residual", str(BOUND), "--out", tmp_path / "o")
    told = run("certify", source, target, *options)
    assert told.code == 0
    assert "planes, of the least squares alone" in told.out
    verified = run("verify", tmp_path / "o" / "certificate.json")
    assert verified.out.rstrip().endswith("VERIFIED")
    again = run("report", tmp_path / "o" / "certificate.json", "--out", tmp_path / "again.html")
    assert again.code == 0
    assert (tmp_path / "again.html").read_bytes() == (tmp_path / "o/report.html").read_bytes()
