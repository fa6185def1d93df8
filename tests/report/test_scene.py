"""What the script of the page is given to draw: from where the clouds are seen, and whose names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from strategies import random_rotation

from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.report.viewer import NAMED, Names, scene_document

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
