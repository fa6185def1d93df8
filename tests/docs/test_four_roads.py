"""The page "Four methods, four equilibria": every cell runs and says what the text says."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "four-roads.md"
CELLS = re.findall(
    r"```\{code-cell\} python3\n(?::tags:[^\n]*\n)?(.*?)```", PAGE.read_text("utf-8"), re.DOTALL
)


@pytest.fixture(scope="module")
def run():
    """The page's names after all cells, and all that they printed."""
    import matplotlib as mpl

    mpl.use("Agg")
    names: dict = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for cell in CELLS:
            exec(compile(cell, PAGE.name, "exec"), names)  # noqa: S102 (our own page)
    return names, printed.getvalue()


@pytest.mark.slow
def test_every_cell_runs_and_the_methods_agree(run):
    names, printed = run
    assert len(CELLS) == 15
    assert names["elimination"].dimension == names["ideal"].degree == 4
    assert "The roads spectral, groebner, homotopy agree" in printed
    assert "disjoint: True" in printed
    assert "At most four rotations" in printed


@pytest.mark.slow
def test_near_a_tie_the_exact_methods_decide_and_the_third_is_right_or_in_doubt(run):
    lines = [line for line in run[1].splitlines() if re.match(r"1e-\d\d ", line)]
    assert len(lines) == 5
    assert all("spectral: exact, groebner: exact" in line for line in lines)
    assert all(re.search(r"homotopy: (enclosed|in doubt|not decided)", line) for line in lines)


@pytest.mark.slow
def test_the_figure_marks_every_equilibrium_and_every_circle(run):
    """Each section has its centre and two pairs of opposite points, or a circle for them."""
    names, _ = run
    axes = names["rows"].ravel()
    assert [len(ax.collections) for ax in axes] == [5, 5, 5, 3, 3, 3]  # shades, lines, marks
    assert [len(ax.lines) for ax in axes] == [0, 0, 0, 1, 1, 1]
