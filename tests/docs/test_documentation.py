"""The documentation says nothing that is not run; what is wrong in it stops its build."""

from __future__ import annotations

import hashlib
import html as markup
import importlib
import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from test_guides import GUIDES

import certreg
from certreg.cli.main import cli
from derivations import book
from derivations.coq.theorems import theorems

if TYPE_CHECKING:
    from collections.abc import Callable

pytest.importorskip("sphinx", reason="the dependency group docs is not installed")

DOCS = Path(__file__).parents[2] / "docs"
PAGES = [page for page in sorted(DOCS.rglob("*.md")) if "_build" not in page.parts]
MATHJAX = "a4354ff94fd868aea0cc6eaaa79a57fda0588646fc46ee3700a349ee0a11cbe6"  # npm, mathjax@3.2.2
NOT_CODE = {"text", "json", "coq"}  # not executed; `make proofs` holds the Coq against its files
FENCE = re.compile(r"^(`{3,}|~{3,}|:{3,})(?P<info>\S[^\n]*)?\n.*?^\1\s*$", re.MULTILINE | re.DOTALL)
MENTION = re.compile(r"`certreg ([a-z]+)[ `]")

BUILD = """\
import dataclasses
import sys

sys.path[:0] = [{extensions!r}, {root!r}]
extensions = [
    "myst_nb", "citations", "command_lines", "contents", "disclosure", "leftovers", "proofs"
]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_raise_on_error = False
nb_execution_show_tb = True
"""
FALSE_CLAIM = """
from derivations import book
from derivations.claims import davenport

wrong = davenport.CLAIM.controls["K of the transpose of C"]
book.claim = lambda name: dataclasses.replace(davenport.CLAIM, proof=wrong)
"""
TOOTHLESS_CLAIM = """
from derivations import book
from derivations.claims import davenport

book.claim = lambda name: dataclasses.replace(
    davenport.CLAIM, controls={"nothing is mutated": davenport.proof}
)
"""
STALE_CLAIM = """
from derivations import book
from derivations.claims import davenport

STALE = dataclasses.replace(davenport.CLAIM, used_by=("certreg.geometry.so3.gone",))
book.claim = lambda name: STALE
"""
NOTEBOOK = """\
---
jupytext: {text_representation: {extension: .md, format_name: myst}}
kernelspec: {name: python3, display_name: Python 3}
---
"""


@pytest.fixture
def extension(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], Any]:
    """Imports a file of docs/_ext."""
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    return importlib.import_module


def built(folder: Path, page: str, settings: str = "") -> subprocess.CompletedProcess[str]:
    """The finished build of a site of one page, warnings being errors."""
    conf = BUILD.format(extensions=str(DOCS / "_ext"), root=str(DOCS.parent))
    (folder / "conf.py").write_text(conf + settings, "utf-8")
    (folder / "index.md").write_text(page, "utf-8")
    (folder / "bibliography.md").write_text(
        "---\norphan: true\n---\n# Works\n\n```{entry} Horn1987\nHorn.\n```\n"
        "```{entry} Davenport1968\nDavenport.\n```\n",
        "utf-8",
    )
    listed = "".join(f"### {name}\n\n" for name in theorems())
    (folder / "machine-checked-proofs.md").write_text(
        f"---\norphan: true\n---\n# Theorems\n\n## All\n\n{listed}", "utf-8"
    )
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "-b", "html", folder, folder / "html"]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_mathjax_is_the_published_file():
    file = DOCS / "_static" / "vendor" / "tex-svg-full.js"

    assert hashlib.sha256(file.read_bytes()).hexdigest() == MATHJAX


def test_every_public_name_is_in_the_reference():
    described = (DOCS / "reference" / "python.md").read_text("utf-8")

    patterns = {name: rf":: certreg\.{name}$" for name in certreg.__all__}
    missing = [n for n, p in patterns.items() if not re.search(p, described, re.MULTILINE)]
    assert missing == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(DOCS)))
def test_a_page_shows_no_code_that_is_not_run(page: Path):
    if page in GUIDES:
        return  # their commands, C and Python are run by tests/docs/test_guides.py
    infos = [match["info"] or "" for match in FENCE.finditer(page.read_text("utf-8"))]

    assert [info for info in infos if not info.startswith("{") and info not in NOT_CODE] == []


def test_code_that_is_not_run_is_seen():
    infos = [match["info"] for match in FENCE.finditer("a\n```python\nx = 1\n```\nb\n")]

    assert infos == ["python"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(DOCS)))
def test_a_page_speaks_of_commands_that_exist(page: Path):
    assert set(MENTION.findall(page.read_text("utf-8"))) <= set(cli.commands)


def test_a_claim_becomes_a_theorem_with_steps_and_controls(tmp_path: Path):
    done = built(tmp_path, "# Page\n\n```{proof} davenport\n```\n")
    html = (tmp_path / "html" / "index.html").read_text("utf-8")

    assert done.returncode == 0, done.stderr
    assert html.count('id="step-') == 3
    assert 'href="bibliography.html#cite-horn1987"' in html
    assert "K of the transpose of C" in html
    assert "PROVED" in html


def test_a_claim_shows_its_theorems_in_coq_as_their_files_state_them(tmp_path: Path):
    done = built(tmp_path, "# Page\n\n```{proof} eigenvectors\n```\n")
    page = (tmp_path / "html" / "index.html").read_text("utf-8")
    words = markup.unescape(re.sub(r"<[^>]*>", "", page))

    assert "xref_missing" not in done.stderr
    assert "Not proved in Coq:" in words
    for name in book.claim("eigenvectors").coq:
        theorem = theorems()[name]
        assert theorem.statement in words
        assert f'href="machine-checked-proofs.html#{name.replace("_", "-")}"' in page
        assert all(words.count(each) >= 2 for each in theorem.hypotheses)
        assert all(axiom in words for axiom in theorem.axioms)


def test_a_claim_without_a_theorem_in_coq_says_so(tmp_path: Path):
    done = built(tmp_path, "# Page\n\n```{proof} polar_projection\n```\n")
    page = (tmp_path / "html" / "index.html").read_text("utf-8")

    assert "xref_missing" not in done.stderr
    assert "<strong>Not machine-checked.</strong>" in page


@pytest.mark.parametrize("name", ["optimality_certificate", "spectrum"])
def test_formulas_are_set_as_formulas_wherever_they_stand(tmp_path: Path, name: str):
    done = built(tmp_path, f"# Page\n\n```{{proof}} {name}\n```\n")
    html = (tmp_path / "html" / "index.html").read_text("utf-8")

    assert "a formula is left in the text" not in done.stderr
    assert "$" not in re.sub(r"<pre>.*?</pre>", "", html, flags=re.DOTALL)


@pytest.mark.parametrize(
    ("page", "settings", "complaint"),
    [
        ("```{proof} davenport\n```\n", FALSE_CLAIM, "is refuted, not proved"),
        ("```{proof} davenport\n```\n", TOOTHLESS_CLAIM, "is inconclusive, not proved"),
        ("```{proof} davenport\n```\n", STALE_CLAIM, "no code is called certreg.geometry.so3.gone"),
        ("```{proof} nonsense\n```\n", "", "the book has no claim 'nonsense'"),
        ("{claim}`nonsense`\n", "", "the book has no claim 'nonsense'"),
        ("As in [Nobody1999].\n", "", "[Nobody1999] is not in the bibliography"),
        ("It costs $$ a\n+ b $$ and more.\n", "", "a formula is left in the text"),
        ("At every R^*, or $R*, say.\n", "", "a formula is left in the text"),
        ("```{command} certreg info --nonsense\n```\n", "", "ended with 2, not 0"),
        ("```{command} certreg info\n:exit: 3\n```\n", "", "ended with 0, not 3"),
        ("```{command} rm -r survey\n```\n", "", "pages run certreg"),
        ("```{code-cell} ipython3\n1 / 0\n```\n", "notebook", "ZeroDivisionError"),
    ],
    ids=lambda value: value.strip().splitlines()[0][:40] if value else "",
)
def test_what_is_wrong_stops_the_build(tmp_path: Path, page: str, settings: str, complaint: str):
    head = NOTEBOOK if settings == "notebook" else ""
    done = built(tmp_path, f"{head}# Page\n\n{page}", "" if head else settings)

    assert done.returncode != 0
    assert complaint in done.stderr


def test_lines_that_are_left_out_are_marked(extension: Callable[[str], Any]):
    chosen = extension("command_lines").chosen

    assert chosen(list("abcdef"), "2-3, 5") == ["[...]", "b", "c", "[...]", "e", "[...]"]
    assert chosen(list("ab"), "1-2") == ["a", "b"]
    assert chosen(list("ab"), None) == ["a", "b"]


def test_a_docstring_is_prose_with_fields_equations_and_examples(extension: Callable[[str], Any]):
    lines = [
        "|q|^2 of R_b, `code`s.",
        "",
        "q: (4,), w",
        "    first.",
        "Raises X.",
        "",
        "    y = *x",
    ]
    expected = [r"\|q\|^2 of R\_b, ``code``\ s.", ":q: (4,), w", "    first.", "Raises X."]

    marked = [line for line in extension("docstrings").marked_up(lines) if line]

    assert marked == [*expected, "::", "    y = *x"]
    assert extension("docstrings").marked_up([">>> f(*x)", "1"])[1:3] == [">>> f(*x)", "1"]


def test_the_keys_of_a_schema_are_listed_with_their_paths(extension: Callable[[str], Any]):
    inner = {"properties": {"b": {"type": ["number", "null"], "description": "B."}}}
    schema = {"properties": {"a": {"anyOf": [inner, {"type": "null"}]}, "c": {"const": 1}}}

    assert list(extension("interface").keys_of(schema)) == [
        ("a", "anything | null", ""),
        ("a.b", "number | null", "B."),
        ("c", "1", ""),
    ]
