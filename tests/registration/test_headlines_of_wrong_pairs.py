"""First lines of pairs that may be wrong: all of them are on the page of headlines."""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from rotated_pairs import BOUND, rotated_pairs
from scipy.spatial.transform import Rotation
from test_consensus import certified, relabelled, wrong_pairs
from test_label_assessment import judged

import certreg
from certreg.certificate.joint_feasibility import CommonMotion
from certreg.registration import pair_words
from certreg.registration.label_assessment import KeptPairs, TruncatedLabels
from certreg.registration.labelled import ConsensusRegistration, TruncatedRegistration

if TYPE_CHECKING:
    from collections.abc import Iterator

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "headlines.md"
TITLE = "\n## Of pairs that may be wrong\n"
ROW = re.compile(r"^\| `(?P<line>[^`]+)` \| (?P<codes>[\d, ]+) \| .+ \|$", re.MULTILINE)
LISTED_BRACES = re.compile(r"^\| (?P<names>(?:`\{\w+\}` ?)+) \| .+ \|$", re.MULTILINE)
BRACES = re.compile(r"\{(\w+)\}")
KINDS = (ConsensusRegistration, TruncatedRegistration)


def section() -> str:
    """What the page says of them."""
    return PAGE.read_text("utf-8").split(TITLE)[1].split("\n## ")[0]


def rows() -> dict[str, set[int]]:
    """The codes of each line on the page."""
    found = ROW.finditer(section())
    return {one["line"]: {int(code) for code in one["codes"].split(", ")} for one in found}


def said_by(function: Any) -> list[str]:
    """The lines in the source of a function, {} for each number."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    said = [one.value for one in ast.walk(tree) if isinstance(one, ast.Return)]
    assert all(isinstance(one, ast.JoinedStr | ast.Name) for one in said)
    lines = [one for one in said if isinstance(one, ast.JoinedStr)]
    lines.sort(key=lambda one: one.lineno)
    return ["".join(text(part) for part in line.values) for line in lines]


def said_of(kind: type) -> list[str]:
    """The lines in its table, each behind its verdict."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(kind)))
    tables = [one for one in ast.walk(tree) if isinstance(one, ast.AnnAssign)]
    (table,) = [one.value for one in tables if ast.unparse(one.target) == "SAID"]
    assert isinstance(table, ast.Dict)
    lines: list[str] = []
    for verdict, said in zip(table.keys, table.values, strict=True):
        assert isinstance(verdict, ast.Attribute)
        assert isinstance(said, ast.Lambda)
        assert isinstance(said.body, ast.JoinedStr)
        lines.append(f"{verdict.attr}: {''.join(map(text, said.body.values))}")
    return lines


def text(part: ast.expr) -> str:
    return str(part.value) if isinstance(part, ast.Constant) else "{}"


def test_the_page_has_the_lines_in_the_words_of_the_program():
    properties = [inspect.getattr_static(kind, "headline").fget for kind in KINDS]
    said = [line for one in (pair_words.headline, *properties) for line in said_by(one)]
    said += [line for kind in (KeptPairs, TruncatedLabels) for line in said_of(kind)]

    assert [BRACES.sub("{}", line) for line in rows()] == said


def test_every_brace_is_explained():
    told = [name for one in LISTED_BRACES.finditer(section()) for name in BRACES.findall(one[0])]

    assert sorted(told) == sorted({name for line in rows() for name in BRACES.findall(line)})


def consensus_lines() -> Iterator[tuple[str, int]]:
    """Lines of labels beside a rigid motion, and the codes."""
    result = certified(*wrong_pairs(1))
    for met, upper, labels in (
        (14, 14, "i" * 14 + "o" * 6),
        (20, 20, "i" * 20),
        (14, 14, "i" * 13 + "?" * 7),
        (14, 15, "i" * 14 + "o" * 5 + "?"),
        (14, 15, "?" * 20),
    ):
        found = replace(result.found, met=tuple(range(met)), upper=upper, labels=labels)
        one = relabelled(result, found)
        yield one.headline, one.exit_code


def scaled_lines() -> Iterator[tuple[str, int]]:
    """Six pairs at the scale 1, six at 2: each is a maximum."""
    source = np.random.default_rng(5).uniform(-1, 1, (12, 3))
    target = source + np.array([1.0, 2.0, 3.0])
    target[6:] = 2.0 * source[6:] @ Rotation.from_rotvec([0.3, -1.2, 0.4]).as_matrix().T
    result = certified(source, target, 0.01, scale="asymmetric")
    yield result.headline, result.exit_code
    above = relabelled(result, replace(result.found, upper=7))
    yield above.headline, above.exit_code


def rotation(source: Any, target: Any, bound: float) -> TruncatedRegistration:
    model: dict[str, Any] = {"rotation_only": True, "objective": "truncated"}
    result = certreg.certify(source, target, max_residual=bound, **model)
    assert isinstance(result, TruncatedRegistration)
    return result


def truncated_lines() -> Iterator[tuple[str, int]]:
    """Lines of truncated squares, and of labels that are judged beside them."""
    given = rotated_pairs(np.random.default_rng(3), 12, 0.5)
    line = np.outer([1.0, 2.0, 3.0], [1.0, 0.0, 0.0])  # which turns about itself
    sure, turning = rotation(given.source, given.target, BOUND), rotation(line, line, 0.1)
    unsure = replace(sure, labels=("undecided",) * 12)
    for one in (sure, turning, unsure, replace(unsure, certificate=None)):
        yield one.headline, one.exit_code
    right = tuple(np.flatnonzero(given.true).tolist())
    for optimum, kept, disproved in (
        (sure, right, False),
        (sure, right[1:], False),
        (unsure, right, True),
        (unsure, right, False),
    ):
        one = replace(TruncatedLabels.of(optimum, kept), disproved=disproved)
        yield one.headline, one.exit_code


def labels_lines() -> Iterator[tuple[str, int]]:
    """Lines of labels that are judged beside rigid motions."""
    kept = judged(*wrong_pairs(1), [1] * 14 + [0] * 6)
    for one in (
        kept,
        replace(kept, motion=CommonMotion()),
        replace(kept, motion=CommonMotion(refuted=(0, 19))),
    ):
        yield one.headline, one.exit_code


def pattern(line: str) -> re.Pattern[str]:
    """What a line is with any numbers."""
    return re.compile(".*".join(re.escape(part) for part in re.split(r"\{\w+\}", line)))


@pytest.mark.slow
def test_every_line_ends_with_a_code_of_its_row():
    listed = {pattern(line): codes for line, codes in rows().items()}
    reached = dict[re.Pattern[str], set[int]]()
    for made in (consensus_lines, scaled_lines, truncated_lines, labels_lines):
        for line, code in made():
            rows_of = [one for one in listed if one.fullmatch(line)]
            assert rows_of, line
            for one in rows_of:
                reached.setdefault(one, set()).add(code)

    assert reached == listed
