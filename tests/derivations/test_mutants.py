"""No mutant of a shipped formula survives the derivations."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from mutants import MUTANTS

SCRIPT = Path(__file__).parents[1] / "mutants.py"


@pytest.mark.slow
def test_every_mutant_of_a_shipped_formula_is_noticed():
    run = subprocess.run(
        [sys.executable, str(SCRIPT)], capture_output=True, text=True, check=True, timeout=240
    )
    noticed = json.loads(run.stdout)

    assert len(noticed) == len(MUTANTS) >= 30
    assert [says for says, claim in noticed.items() if claim is None] == []


@pytest.mark.slow
def test_the_unmutated_formula_is_not_noticed():
    same = MUTANTS[0]
    code = (
        "import sys; sys.path[:0] = [sys.argv[1], sys.argv[2]]; import mutants as m; "
        "honest = m.Mutant('none', m.SO3, m.MUTANTS[0].old, m.MUTANTS[0].old, ('davenport',)); "
        "print(m.noticed(honest))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code, str(SCRIPT.parent), str(SCRIPT.parent.parent)],
        capture_output=True,
        text=True,
        check=True,
    )

    assert same.claims == ("davenport",)
    assert run.stdout.strip() == "None"
