"""What a long search says on a terminal."""

from __future__ import annotations

import logging
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import certreg
from certreg.cli import wrong_pairs
from certreg.cli.main import main

if TYPE_CHECKING:
    from pathlib import Path as Folder

TOLD = "8 of 8 pairs within their bounds, at most 8 (proved); searching on ..."


def clouds(folder: Folder) -> list[str]:
    """Two files of the same points."""
    names = [str(folder / name) for name in ("a.csv", "b.csv")]
    points = np.random.default_rng(0).uniform(size=(8, 3))
    for name in names:
        Path(name).write_text(
            "\n".join(",".join(map(repr, row)) for row in points.tolist()), encoding="utf-8"
        )
    return names


@pytest.mark.parametrize(
    ("terminal", "patience", "told"), [(1, -1.0, 1), (0, -1.0, 0), (1, 9.0, 0)]
)
def test_a_search_that_takes_long_says_how_far_it_is(
    tmp_path, monkeypatch, capsys, terminal, patience, told
):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: bool(terminal))
    monkeypatch.setattr(wrong_pairs, "PATIENCE", patience)
    monkeypatch.setattr(
        sys, "argv", ["certreg", "certify", *clouds(tmp_path), "--max-residual", ".1"]
    )
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    assert (TOLD in capsys.readouterr().err) == bool(told)
    assert not logging.getLogger(wrong_pairs.SEARCH).handlers


def test_the_log_tells_it_too(monkeypatch):
    told: list[str] = []
    log = logging.getLogger(wrong_pairs.SEARCH)
    monkeypatch.setattr(log, "info", lambda words, *numbers: told.append(words % numbers))
    points = np.random.default_rng(0).uniform(size=(8, 3))
    certreg.certify(points, points, max_residual=0.1)
    assert told[-1] == TOLD
