"""What a card and a page draw and list: from where, whose names, each at its own place."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from strategies import random_rotation

from certreg import RegistrationProblem, certify
from certreg.geometry.so3 import rotation_matrix
from certreg.report.cards import registration_card
from certreg.report.picture import SOURCE, registration_picture
from certreg.report.thinning import PUSH, simulated_escapes
from certreg.report.viewer import NAMED, Names, scene_document

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.registration.result import Registration


AXES = np.array([[3, 0, 0], [-3, 0, 0], [0, 2, 0], [0, -2, 0], [0, 0, 1], [0, 0, -1]], float)
TURN = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix()
OFF = 4  # the row whose target is moved


@pytest.fixture(scope="module")
def found() -> Registration:
    target = AXES @ TURN.T
    target[OFF] += 6.0 * TURN[:, 2]
    return certify(RegistrationProblem(AXES, target), relaxation=False, simulation=False)


def test_a_body_is_pushed_about_its_own_axis(found: Registration):
    """Not about the axis of space that has the same three numbers: the pose is no axis' own."""
    components = found.equilibria.components
    for run in simulated_escapes(found.solution, 2.0):
        assert run.start is not None
        component = components[run.start]
        axis = component.witness
        assert axis is not None
        begun = Rotation.from_matrix(rotation_matrix(run.quaternions[0].tolist()))
        rest = Rotation.from_matrix(component.rotation)

        assert (rest.inv() * begun).as_rotvec() == pytest.approx(PUSH * axis, abs=1e-9)
        assert (begun * rest.inv()).as_rotvec() != pytest.approx(PUSH * axis, abs=1e-3)


def test_rings_are_the_target_and_dots_the_moved_source(found: Registration):
    """The row that is off is off in the target: its ring is farther off than its dot."""
    picture = registration_picture(found)
    assert picture is not None
    rings, dots = (np.array(each, float) for each in (picture.rings, picture.dots))
    springs = np.array(picture.springs, float)
    spokes = np.array(picture.spokes, float)

    away = [np.linalg.norm(each[OFF] - np.delete(each, OFF, 0).mean(0)) for each in (rings, dots)]
    assert away[0] > 1.5 * away[1]
    assert (springs == np.hstack([rings, dots])).all()
    assert (spokes[:, 2:] == rings).all()
    assert spokes[:, :2] == pytest.approx(np.tile(rings.mean(0), (len(AXES), 1)), abs=0.1)


def test_a_card_draws_rings_empty_and_dots_in_the_colour_of_the_source(found: Registration):
    picture = registration_picture(found)
    assert picture is not None
    drawn = {
        re.sub(r'.*fill="([^"]*)".*', r"\1", head): re.findall(r'cx="([^"]*)" cy="([^"]*)"', body)
        for head, body in re.findall(r"(<g [^>]*fill[^>]*>)(.*?)</g>", registration_card(found))
    }

    assert drawn["none"] == list(picture.rings)
    assert drawn[SOURCE] == list(picture.dots)


def test_the_columns_of_a_card_are_what_their_heads_say(found: Registration):
    card = found.equilibria._repr_html_()
    heads = re.findall(r"<th[^>]*>(.*?)</th>", card)
    cells = np.array(re.findall(r"<td[^>]*>(.*?)</td>", card)).reshape(-1, len(heads))
    columns = dict(zip(heads, cells.T.tolist(), strict=True))
    parts = found.equilibria.components

    assert heads == ["index", "kind", "RMSE", "energy", "to optimum", "unstable", ""]
    assert columns["index"] == [str(part.morse_index) for part in parts]
    assert columns["kind"] == ["point"] * 4
    assert [float(each) for each in columns["RMSE"]] == pytest.approx([p.rmse for p in parts])
    assert [float(each) for each in columns["energy"]] == pytest.approx([p.energy for p in parts])
    assert [float(each.removesuffix(" deg")) for each in columns["to optimum"]] == (
        pytest.approx([np.degrees(p.angle_to_optimum) for p in parts], rel=1e-5)
    )


RNG = np.random.default_rng(23)


def scene(target: NDArray[np.float64], labels: list[str] | None = None) -> dict[str, Any]:
    problem = RegistrationProblem(target[:, [1, 2, 0]], target)
    registration = certify(problem, relaxation=False, simulation=False)
    about = {} if labels is None else {"labels": labels}
    return scene_document(registration, Names.of(about, len(target)))


def cloud(n: int) -> NDArray[np.float64]:
    return RNG.normal(size=(n, 3)) * [3.0, 2.0, 1.0]


@pytest.mark.parametrize("size", [1e-150, 1.0, 1e150])
def test_z_points_up_and_the_longest_way_goes_across(size: float):
    points = cloud(50) @ random_rotation(RNG).T * size
    axes = np.array(scene(points)["axes"])
    flat = (points - points.mean(axis=0))[:, :2] / size
    across = flat @ axes[0, :2]

    assert axes[2].tolist() == [0.0, 0.0, 1.0]
    assert np.allclose(axes @ axes.T, np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert across.var() == pytest.approx(np.linalg.eigvalsh(np.cov(flat.T, bias=True))[-1])


@pytest.mark.parametrize("slope", [-0.6, 0.6])
def test_a_slope_rises_to_the_back(slope: float):
    points = cloud(50) * [1.0, 1.0, 0.0]
    points[:, 2] = slope * points[:, 1]
    away = np.array(scene(points)["axes"])[1]

    assert (points - points.mean(axis=0)) @ away @ points[:, 2] > 0.0


def test_a_single_spot_and_a_vertical_line_are_seen_from_somewhere():
    for points in (np.ones((3, 3)), np.outer(np.arange(4.0), [0.0, 0.0, 1.0])):
        axes = np.array(scene(points)["axes"])
        assert np.allclose(axes @ axes.T, np.eye(3))


@pytest.mark.slow
def test_all_of_few_points_are_named_and_of_many_those_that_do_not_fit():
    few, many = cloud(NAMED), cloud(NAMED + 1)
    names = [f"P{i}" for i in range(NAMED + 1)]
    wrong = many + 1e-3 * RNG.normal(size=many.shape)
    wrong[5] += 40.0
    registration = certify(RegistrationProblem(many, wrong), relaxation=False, simulation=False)

    def named(labels: list[str] | None) -> Any:
        about = {} if labels is None else {"labels": labels}
        return scene_document(registration, Names.of(about, len(many)))["named"]

    assert scene(few, names[:NAMED])["named"] == list(enumerate(names[:NAMED]))
    assert scene(few)["named"] == scene(many, names)["named"] == []
    assert named(names) == [(5, "P5")]
    assert named(None) == [(5, "row 5")]
