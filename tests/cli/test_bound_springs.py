"""`verify` beside clouds with springs: what is wrong with those that were given, and the remedy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg

if TYPE_CHECKING:
    from pathlib import Path

RNG = np.random.default_rng(3)
X, N = RNG.normal(size=(2, 12, 3))
Y = X + 0.05 * RNG.normal(size=X.shape)
OTHERS = (
    "REFUSED: the certified springs are others, or not given: as for certify give --springs KIND, "
    "--normals FILE or the like, and --sigma or --weights\n"
)
NUMBER = "REFUSED: the certificate is about another number of points or "


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place: Path = tmp_path_factory.mktemp("bound")
    for name, rows in (("x", X), ("y", Y), ("n", N), ("m", N[::-1])):
        np.save(place / f"{name}.npy", rows)
    clouds = place / "x.npy", place / "y.npy"
    left_out = "--no-relaxation", "--no-simulation", "--robustness-angle", "5"
    certreg("certify", *clouds, "--normals", place / "n.npy", "--sigma", 0.5, "--out", place / "s")
    certreg("certify", *clouds, *left_out, "--out", place / "i")
    return place


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize(
    ("kind", "options", "code", "said"),
    [
        ("s", ("--normals", "n", "--sigma", 0.5), 0, "VERIFIED"),
        ("s", (), 1, OTHERS),
        ("s", ("--sigma", 0.5), 1, f"{NUMBER}springs\n"),
        ("s", ("--normals", "n"), 1, OTHERS),
        ("s", ("--normals", "n", "--sigma", 0.25), 1, OTHERS),
        ("s", ("--normals", "m", "--sigma", 0.5), 1, OTHERS),
        ("s", ("--directions", "n", "--sigma", 0.5), 1, OTHERS),
        ("s", ("--any-weight",), 1, OTHERS),
        ("i", ("--normals", "n"), 1, f"{NUMBER}weights\n"),
        ("i", (), 0, "VERIFIED"),
    ],
)
def test_the_remedy_names_what_is_missing(
    folder: Path, kind: str, options: tuple[Any, ...], code: int, said: str
):
    given = [folder / f"{one}.npy" if one in {"n", "m"} else one for one in options]
    clouds = folder / "x.npy", folder / "y.npy"
    run = certreg("verify", folder / kind / "certificate.json", *clouds, *given)

    assert run.code == code
    assert said in run.out


def test_any_weight_goes_without_springs(folder: Path):
    given = "--normals", folder / "n.npy", "--any-weight"
    clouds = folder / "x.npy", folder / "y.npy"
    run = certreg("verify", folder / "s" / "certificate.json", *clouds, *given)

    assert run.code == 2
    assert "--any-weight goes without springs: give the --sigma that was certified" in run.err


def test_apply_says_that_normals_are_left_out(folder: Path, tmp_path: Path):
    rows = "\n".join(",".join(map(repr, row)) for row in np.hstack([X, N]).tolist())
    (tmp_path / "cloud.csv").write_text(f"x,y,z,nx,ny,nz\n{rows}\n", encoding="utf-8")
    run = certreg("apply", folder / "s", tmp_path / "cloud.csv", "--out", tmp_path / "moved.csv")

    assert run.code == 0
    assert "cloud.csv: columns not moved and not written: nx, ny, nz" in run.err
    moved = certreg("apply", folder / "s", folder / "x.npy", "--out", tmp_path / "moved.csv")
    assert moved.err == ""
