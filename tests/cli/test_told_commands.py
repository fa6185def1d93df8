"""A command that is printed can be typed, whatever the names of the files are."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from commands import certreg

from certreg import _loading

DATA = Path(_loading.__file__).parent / "data"
CLOUDS = (DATA / "survey_source.csv", DATA / "survey_target.csv")
LIGHT = ("--no-relaxation", "--no-simulation")
LINES = {
    "certify": ("certify", *CLOUDS, *LIGHT, "--out"),
    "wrong pairs": ("certify", *CLOUDS, "--max-residual", "20", "--out"),
    "equilibria": ("equilibria", *CLOUDS, "--out"),
}


@pytest.mark.parametrize("name", LINES)
def test_the_certificate_that_was_written_is_checked_by_what_is_printed(name: str, tmp_path: Path):
    run = certreg(*LINES[name], tmp_path / "we <i> & 'x'")
    (typed,) = re.findall(r"\((?:re-check it: )?certreg (verify .*)\)\n", run.out + run.err)

    assert run.code == 0
    assert certreg(*shlex.split(typed)).code == 0
