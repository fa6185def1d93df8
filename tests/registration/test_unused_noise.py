"""Columns `sigma` and `weight` of clouds: used by `certify`, told of where nobody uses them."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import certreg
from certreg.errors import UnusedNoiseWarning

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

RNG = np.random.default_rng(12)
X = RNG.normal(size=(20, 3))
Y = X[:, [1, 2, 0]] + 0.01 * RNG.normal(size=X.shape)
SIGMA = np.linspace(0.01, 0.1, 20)


def written(folder: Path, name: str, points: Any, column: str = "", values: Any = None) -> Any:
    rows = np.column_stack([points] if values is None else [points, values])
    header = "x,y,z" + (f",{column}" if column else "")
    np.savetxt(folder / name, rows, delimiter=",", header=header, comments="", fmt="%.17g")
    return certreg.load(folder / name)


@pytest.mark.parametrize(
    ("call", "remedy"),
    [
        (certreg.register, "sigma=target.sigma uses it"),
        (lambda x, y: certreg.register(x, y, normals=y.points), "sigma=target.sigma uses"),
        (certreg.RegistrationProblem, "sigma=target.sigma uses it"),
        (lambda x, y: certreg.RegistrationProblem(*certreg.pair(x, y)), "sigma=target.sigma uses"),
    ],
)
def test_a_column_sigma_that_is_not_used_is_told_of_where_the_user_called(
    tmp_path: Path, call: Callable[[Any, Any], Any], remedy: str
):
    source = written(tmp_path, "a.csv", X)
    target = written(tmp_path, "b.csv", Y, "sigma", SIGMA)

    with pytest.warns(UnusedNoiseWarning) as told:
        call(source, target)

    assert [one.filename for one in told] == [__file__]
    words = str(told[0].message)
    assert words.startswith("target has a column sigma, which is not used: all pairs count alike. ")
    assert remedy in words


def test_what_the_warning_says_to_type_gives_what_certify_uses(tmp_path: Path):
    source = written(tmp_path, "a.csv", X)
    target = written(tmp_path, "b.csv", Y, "sigma", SIGMA)
    weighed = written(tmp_path, "c.csv", X, "weight", SIGMA)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        proved = certreg.certify(source, target, relaxation=False, simulation=False)
        posed = certreg.register(source, target, sigma=target.sigma)
        problem = certreg.RegistrationProblem(source, target, sigma=target.sigma)
        certreg.register(source.points, target.points)
        certreg.RegistrationProblem(weighed, target, weights=weighed.weights)

    assert problem.digest() == proved.problem.digest()
    assert np.abs(posed.rotation - proved.pose.rotation).max() < 1e-12
    with pytest.warns(
        UnusedNoiseWarning, match=r"^source has a column weight, .*weights=source\.w"
    ):
        certreg.RegistrationProblem(weighed, target.points)


class Frame(SimpleNamespace):
    """As much of a data frame as is asked for."""

    def to_numpy(self) -> Any:
        return X

    def __getitem__(self, name: str) -> Any:
        return self.held[name]


def test_a_column_of_a_data_frame_is_told_of_too():
    names = ["x", "y", "z", "sigma"]
    held = dict(zip(names, [*X.T, SIGMA], strict=True))

    with pytest.warns(UnusedNoiseWarning, match=r'sigma=target\["sigma"\] uses it'):
        certreg.RegistrationProblem(X, Frame(columns=names, held=held))
