"""How pages look, as far as it can be read from the style sheet and the templates."""

from __future__ import annotations

import re
from pathlib import Path

from certreg import report

FOLDER = Path(report.__file__).parent
STYLE = (FOLDER / "assets" / "report.css").read_text("utf-8")
TEMPLATES = {path.name: path.read_text("utf-8") for path in (FOLDER / "templates").glob("*.html")}
SECTION = re.compile(r'call section\("(\w+)".*?endcall', re.DOTALL)
MADE = re.compile(r'Section\(\s*name="(\w+)".*?(?=Section\(|^def |\Z)', re.DOTALL | re.MULTILINE)
MACRO = re.compile(r"macro (\w+)\(.*?endmacro", re.DOTALL)
INCLUDED = re.compile(r'include "report/templates/([\w.]+)"')


def sections(template: str) -> dict[str, str]:
    """The sections of a page, by the name that the style sheet has, with what they include."""
    return {
        found[1]: INCLUDED.sub(lambda one: TEMPLATES[one[1]], found[0])
        for found in SECTION.finditer(template)
    }


def named(rule: str) -> set[str]:
    """The sections of which the style sheet has a rule."""
    (group,) = re.findall(rf"^:is\(([^)]*)\) {re.escape(rule)}", STYLE, re.MULTILINE)
    return set(group.replace("#", "").split(", "))


def test_the_columns_of_every_table_stand_apart():
    tabular = {
        f"{one[1]}("
        for template in TEMPLATES.values()
        for one in MACRO.finditer(template)
        if "<table" in one[0]
    }
    found = {
        name
        for template in TEMPLATES.values()
        for name, text in sections(template).items()
        if any(words in text for words in ("<table", *tabular))
    }
    found |= {
        one[1]
        for path in FOLDER.glob("*.py")
        for one in MADE.finditer(path.read_text("utf-8"))
        if re.search("table=|course=", one[0])
    }

    assert found == {"worst", "listed", "residuals", "undecided", "course"}
    assert named("table { border-collapse: collapse; }") == found
    assert named(":is(th, td) { text-align: left; padding: .1rem 1.4rem .1rem 0; }") == found
