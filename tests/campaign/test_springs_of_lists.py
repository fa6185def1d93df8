"""Lists of pairs name springs: kinds of columns, and files beside the list."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

import certreg
from certreg.campaign.listing import read_listing
from certreg.campaign.pairs import _inputs, _problem
from certreg.errors import InvalidProblemError

if TYPE_CHECKING:
    from pathlib import Path

RNG = np.random.default_rng(8)
X, Y, N = RNG.standard_normal((3, 5, 3))
HEAD = "source,target,springs,normals,factors"
ROWS = ("plane,,", ",n.npy,", "line plane,,", "no,,")


@pytest.fixture(name="listed")
def _listed(tmp_path: Path) -> Path:
    np.savetxt(tmp_path / "a.csv", X, "%.17g", ",", header="x,y,z", comments="")
    columns = "x,y,z,nx,ny,nz,dx,dy,dz"
    lines = [",".join(map(repr, row)) for row in np.column_stack([Y, N]).tolist()]
    lines = [f"{line},,," for line in lines]
    (tmp_path / "b.csv").write_text("\n".join([columns, *lines, ""]), "utf-8")
    np.save(tmp_path / "n.npy", N)
    path = tmp_path / "pairs.csv"
    path.write_text("\n".join([HEAD, *(f"a.csv,b.csv,{row}" for row in ROWS), ""]), "utf-8")
    return path


def test_a_list_names_columns_and_files_of_springs(listed: Path) -> None:
    planes = certreg.RegistrationProblem(X, Y, normals=N).digest()

    first, second, third, last = read_listing(listed).rows()

    assert read_listing(listed).ignored == ()
    assert _problem(first, listed.parent)[0].digest() == planes
    assert _problem(second, listed.parent)[0].digest() == planes
    assert _problem(third, listed.parent)[0].digest() == planes  # the lines are all empty
    assert set(_inputs(second, listed.parent)) == {"a.csv", "b.csv", "n.npy"}
    with pytest.raises(InvalidProblemError, match="springs is 'no': give one of plane, line, full"):
        _problem(last, listed.parent)
