"""Every sentence that results are told in stands in a record, or in a test, word for word."""

from __future__ import annotations

import ast
import html
import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from syntax import nodes

import certreg

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parent
PACKAGE = Path(certreg.__file__).parent
WINGS = ("registration", "report")
SENTENCE = re.compile(r"^(?!\w+\[)(?=.*[a-z]{3}.* |[a-z]+ [a-z]+)")  # two words; a type is none
NOT_RECORDED = {
    "the simulation ended where the basin could not be proved": "certreg contradicts itself",
    "the simulation went below the certified minimum": "certreg contradicts itself",
    "contradicts the certified pose: it is": "certreg contradicts itself",
    "degrees away; please report this problem": "certreg contradicts itself",
    "damping %g": "a line of the log",
    "relaxation %s by %s": "a line of the log",
    "%d of %d pairs within their bounds": "a line of the log",
    "fewer than three points with weight leave no degree": "two points have infinitely many optima",
    "the two best eigenvalues are not told apart": "a unique optimum has them told apart",
    ": one turn is hardly determined, beside the others": "of matrices, in tests of covariances",
    ": the files of this registration could not be written": "in tests that fill the disk",
    "the content would end its own <": "a fault of an asset of the page",
    "default-src 'none'; style-src": "the page's policy, with digests of style and script",
    "; img-src data:; base-uri 'none'": "the page's policy",
    "beside sources and targets, whose certificates": "in tests/certificate/test_many.py",
    "projective planes": "of two, which no problem has",
    "the balls are too wide to tell the signs": "a search that fails",
    "it is not computed where the scale is free": "of a problem with a covariance and a scale",
    # Of general springs, in no record yet:
    "the certificate holds no springs": "a certificate of many pairs, without its problem",
    "see the note above": "a fit with a note",
    "The certificate that certreg certify writes": "a certificate that proves little",
    "of several kinds": "kinds that are mixed by matrices",
    "no proposal:": "a solver that fails",
}


def plain(text: str) -> str:
    """Words alone: without marks of HTML and Markdown, one blank between them."""
    words = re.sub(r"</?code>|`", "", html.unescape(text)).replace("±", "+/-")
    return re.sub(r"\s+", " ", words.replace("\u00a0", " "))


@cache
def sentences(source: str) -> tuple[str, ...]:
    """What is between the values in the literals of a module, its docstrings left out."""
    return tuple(_sentences(source))


def _sentences(source: str) -> Iterator[str]:
    documented = {
        id(node.value)
        for node in nodes(source)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in nodes(source):
        if isinstance(node, ast.Constant) and id(node) not in documented:
            parts = re.split(r"\{[^{}]*\}|\n", node.value) if isinstance(node.value, str) else []
            yield from (words for part in parts if SENTENCE.search(words := plain(part).strip()))


def untold(told: str, modules: dict[str, str]) -> dict[str, str]:
    """The sentences that are not told, and in which module each stands."""
    return {
        words: name
        for name, source in modules.items()
        for words in sentences(source)
        if words not in told
        and f"{words[:1].upper()}{words[1:]}" not in told
        and not any(words.startswith(each) for each in NOT_RECORDED)
    }


def modules() -> dict[str, str]:
    paths = (path for wing in WINGS for path in (PACKAGE / wing).glob("*.py"))
    return {str(path.relative_to(PACKAGE)): path.read_text("utf-8") for path in paths}


def told() -> str:
    """All records, and the literals of all tests of these wings and of the commands."""
    records = "\n".join(path.read_text("utf-8") for path in (HERE / "records").glob("*.txt"))
    tests = (path for wing in (*WINGS, "cli", "laws") for path in (HERE.parent / wing).glob("*.py"))
    asserted = "\n".join(path.read_text("utf-8") for path in tests).replace("\\", "")
    joined = re.sub(r'"\s*\n\s*r?f?"', "", asserted)
    return plain(f"{records}\n{joined}")


@pytest.mark.slow
def test_every_sentence_of_a_result_is_told_in_a_record_or_a_test():
    assert untold(told(), modules()) == {}


@pytest.mark.slow
def test_what_is_not_recorded_still_stands_in_the_program():
    said = [words for source in modules().values() for words in sentences(source)]

    assert [each for each in NOT_RECORDED if not any(one.startswith(each) for one in said)] == []


def test_a_sentence_that_is_told_nowhere_is_found():
    source = {"a.py": 'def f(x):\n    """A word."""\n    return f"it is {x} off the best `turn`"\n'}

    assert untold("it is 3 off the turn", source) == {"off the best turn": "a.py"}
    assert untold("It is 3 off the best turn", source) == {}
