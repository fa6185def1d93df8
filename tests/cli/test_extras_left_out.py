"""Every command, with each library left out: it runs, or one line names what it needs.

`test_without_libraries.py` has the words; here is the whole table, of which the suite takes a part.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from commands import certreg
from left_out import endings

from certreg import _loading
from certreg._loading import ORIGINS

DATA = Path(_loading.__file__).parent / "data"
FILES = Path(__file__).parents[1] / "io" / "data"
CLOUDS = (DATA / "survey_source.csv", DATA / "survey_target.csv")

LINES: dict[str, tuple[int, set[str], tuple[object, ...]]] = {  # code, what it needs, arguments
    "certify": (0, {"numpy", "jinja2"}, ("certify", *CLOUDS, "--no-simulation", "--out", "new")),
    "certify --solver": (
        0,
        {"numpy", "scipy", "cvxpy"},
        ("certify", *CLOUDS, "--no-simulation", "--solver", "SCS"),
    ),
    "certify planes": (  # the page lists equilibria only where the library for it is there
        0,
        {"numpy", "jinja2"},
        ("certify", "p.csv", "q.csv", "--springs", "plane", "--out", "planes"),
    ),
    "verify": (0, set(), ("verify", "out/certificate.json")),
    "assess": (1, {"numpy"}, ("assess", *CLOUDS, "--pose", DATA / "flipped.txt")),
    "apply": (0, {"numpy"}, ("apply", "out", CLOUDS[0], "--out", "moved.csv")),
    "report": (0, {"numpy", "jinja2"}, ("report", "out/certificate.json", "--out", "r.html")),
    "equilibria": (0, {"numpy"}, ("equilibria", *CLOUDS)),
    "equilibria, all": (0, {"numpy", "flint"}, ("equilibria", *CLOUDS, "--method", "all")),
    "simulate": (0, {"numpy"}, ("simulate", *CLOUDS)),
    "batch": (0, {"numpy"}, ("batch", "pairs.csv")),
    "batch --parquet": (
        0,
        {"numpy", "pyarrow", "filelock"},
        ("batch", "pairs.csv", "--out", "b", "--parquet"),
    ),
    "batch --scheduler": (
        2,
        {"numpy", "distributed"},
        ("batch", "pairs.csv", "--scheduler", "tcp://nowhere"),
    ),
    "derive": (0, {"numpy", "sympy"}, ("derive", "davenport")),
    "codegen": (0, {"numpy"}, ("codegen", "--out", "c")),
    "info": (0, set(), ("info",)),
    "a .cif": (2, {"numpy", "gemmi"}, ("certify", FILES / "gemmi.cif", CLOUDS[0])),
    "a .las": (2, {"numpy", "laspy"}, ("certify", FILES / "laspy.las", CLOUDS[0])),
    "an .e57": (2, {"numpy", "pye57"}, ("certify", FILES / "pye57.e57", CLOUDS[0])),
}
EXTRAS = sorted({origin.extra for origin in ORIGINS.values() if origin.extra})
LEFT_OUT: dict[str, set[str]] = {
    **{extra: {name for name in ORIGINS if ORIGINS[name].extra == extra} for extra in EXTRAS},
    **{name: {name} for name in ORIGINS if not ORIGINS[name].extra and name != "click"},
    "all extras": {name for name in ORIGINS if ORIGINS[name].extra},
}


@pytest.fixture(scope="module")
def certified(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `certify --out` writes where all is installed."""
    folder = tmp_path_factory.mktemp("certified")
    certreg("certify", *CLOUDS, "--no-simulation", "--out", folder)
    return folder


def write_planes(folder: Path) -> None:
    """Nine points, and the planes on which they lie after a turn about z: p.csv, q.csv."""
    grid = [(x, y, x * y + x - y * y) for x in (-1, 0, 1) for y in (-1, 0, 2)]
    rows = [f"{-y},{x},{z},1,{i % 3},{i // 3 - 1}" for i, (x, y, z) in enumerate(grid)]
    (folder / "p.csv").write_text("\n".join(f"{x},{y},{z}" for x, y, z in grid) + "\n", "utf-8")
    (folder / "q.csv").write_text("\n".join(("x,y,z,nx,ny,nz", *rows)) + "\n", "utf-8")


@pytest.mark.parametrize(
    "which",
    [
        pytest.param(name, marks=pytest.mark.slow if name == "all extras" else pytest.mark.long)
        for name in LEFT_OUT
    ],
)
@pytest.mark.parametrize("every", [6, pytest.param(1, marks=pytest.mark.long)])
def test_each_command_runs_or_ends_in_one_line(
    which: str, every: int, certified: Path, tmp_path: Path
):
    left_out = LEFT_OUT[which]
    write_planes(tmp_path)
    asked = dict([*LINES.items()][::every])
    (tmp_path / "out").symlink_to(certified)
    (tmp_path / "pairs.csv").write_text(f"source,target\n{CLOUDS[0]},{CLOUDS[1]}\n", "utf-8")
    lines = [arguments for *_, arguments in asked.values()]
    ended = endings(left_out, lines, tmp_path, strict=False)
    for name, (code, words) in zip(asked, ended, strict=True):
        needed = LINES[name][1] & left_out
        told = [each for each in words.splitlines() if each and not each.startswith("note: ")]

        assert code == (2 if needed else LINES[name][0]), (name, words)
        assert "Traceback" not in words, name
        assert len(told) == (1 if code == 2 else 0), (name, words)
        if needed:
            missing = [f" needs {ORIGINS[each].name}, which is not installed: " for each in needed]
            assert any(each in told[0] for each in missing), (name, words)
