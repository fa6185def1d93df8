"""Every function that proves is on the list, exists, and no mutant of it goes unnoticed."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from importlib import import_module

import pytest
from function_mutants import (
    EQUIVALENT,
    FREE_CONSTANTS,
    changes,
    constants,
    function_named,
    mutants_of,
)
from mutants import ROOT, functions
from proved_functions import PROVED


def test_every_proved_function_and_each_module_of_its_tests_exists():
    for row in PROVED:
        module = import_module(row.file.removesuffix(".py").replace("/", "."))

        assert set(row.functions) <= functions(module).keys(), row.module
        assert row.tests, row.module
        assert [t for t in row.tests if not (ROOT / "tests" / f"{t}.py").is_file()] == []


def test_no_function_is_listed_twice():
    names = [(row.module, name) for row in PROVED for name in row.functions]

    assert len(names) == len(set(names)) > 150


def test_every_equivalent_mutant_is_a_mutant_and_has_its_reason():
    files = {name.rsplit(":", 2)[0] for name in EQUIVALENT if name.count(":") == 2}
    named = {tuple(name.split(":")[:2]) for name in EQUIVALENT}
    mutants = {mutant.says for file, name in named for mutant in mutants_of(file, name)}

    assert files <= {row.file for row in PROVED}
    assert [name for name in EQUIVALENT if name not in mutants] == []
    assert all(len(reason) > 20 for reason in EQUIVALENT.values())


def test_every_free_constant_is_a_number_that_a_listed_function_names_and_has_its_reason():
    for name, reason in FREE_CONSTANTS.items():
        file, constant = name.split(":")
        module = ast.parse((ROOT / file).read_text("utf-8"))
        listed = [function for row in PROVED if row.file == file for function in row.functions]
        nodes = [n for each in listed for n in ast.walk(function_named(module, each))]

        assert constant in constants(module), name
        assert any(isinstance(n, ast.Name) and n.id == constant for n in nodes), name
        assert len(reason) > 20


OPERATORS = """
def f(a, b, bits):
    "A docstring of 3 words."
    if not (a < b and b >= bits):
        raise ValueError(f"{a + 1} is not below {b - 1}")
    width: Final[3] = min(a[2], -(-b // bits))
    known = a == b != width
    return nextafter(dyadic_above(width + b, bits), math.inf)
"""


def test_each_operator_changes_what_decides_and_no_message_annotation_or_column():
    (function,) = ast.parse(OPERATORS).body

    assert isinstance(function, ast.FunctionDef)
    assert [change.says for change in changes(function, {})] == [
        "not (a < b and b >= bits) -> a < b and b >= bits",
        "a < b and b >= bits -> a < b or b >= bits",
        "a < b and b >= bits -> b >= bits",
        "a < b and b >= bits -> a < b",
        "a < b -> a <= b",
        "b >= bits -> b > bits",
        "min -> max",
        "-(-b // bits) -> b // bits",
        "-b // bits -> -(b // bits)",
        "-b -> b",
        "a == b != width -> a != b != width",
        "a == b != width -> a == b == width",
        "dyadic_above -> dyadic_below",
        "width + b -> width - b",
        "math.inf -> -math.inf",
    ]


CONSTANTS = """
WORD, NAMES, OTHER = "a", ("b", 2), f()
RANGES: dict[int, Fraction] = {3: Fraction(1, 2**9)}
PAIR = (0.5, -1)

def f(a, NAMES):
    return RANGES[a] * max(PAIR) * OTHER * WORD
"""


def test_where_a_function_names_numbers_of_its_module_one_of_them_is_changed():
    module = ast.parse(CONSTANTS)
    named = constants(module)

    assert list(named) == ["RANGES", "PAIR"]
    assert [change.says for change in changes(function_named(module, "f"), named)] == [
        "RANGES -> {3: Fraction(2, 2 ** 9)}",
        "RANGES -> {3: Fraction(0, 2 ** 9)}",
        "RANGES -> {3: Fraction(1, 2 ** 10)}",
        "RANGES -> {3: Fraction(1, 2 ** 8)}",
        "max -> min",
        "PAIR -> (1.0, -1)",
        "PAIR -> (0.25, -1)",
        "PAIR -> (0.5, -2)",
        "PAIR -> (0.5, -0)",
    ]


@pytest.mark.long
def test_no_mutant_of_a_sample_goes_unnoticed_and_a_survivor_is_told():
    """One in a hundred of all; where no test may notice, the exit code is 1."""
    arguments = [
        "-m",
        "benchmarks.rates.mutants",
        "--only",
        "certificate/bounds.py",
        "--every",
        "3",
    ]
    path = {"PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests")))}
    run = subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        env=os.environ | path,
        cwd=ROOT,
        check=False,
    )

    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout[run.stdout.index("{") :])
    assert found["survivors"] == []
    assert found["mutants"] >= 12
