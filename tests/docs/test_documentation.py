"""The documentation says nothing that is not run; what is wrong in it stops its build."""

from __future__ import annotations

import hashlib
import html as markup
import importlib
import pickle
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
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
nodes = pytest.importorskip("docutils.nodes")
new_document = pytest.importorskip("docutils.utils").new_document

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

wrong = davenport.CLAIM.controls["K of the transpose of C"].proof
book.claim = lambda name: dataclasses.replace(davenport.CLAIM, proof=wrong)
"""
TOOTHLESS_CLAIM = """
from derivations import book
from derivations.claims import davenport
from derivations.kernel import Mutation

book.claim = lambda name: dataclasses.replace(
    davenport.CLAIM, controls={"nothing is mutated": Mutation(at=3, proof=davenport.proof)}
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


BIBLIOGRAPHY = """\
---
orphan: true
---
# Works

```{entry} Horn1987
Horn.
```
```{entry} Davenport1968
Davenport.
```
```{entry} Yang2020
Yang.
```
```{entry} Umeyama1991
Umeyama.
```
"""
THEOREMS = "---\norphan: true\n---\n# Theorems\n\n## All\n\n"

# The pages of one site, each with the proof of a claim.
CLAIMS = ("davenport", "eigenvectors", "polar_projection", "optimality_certificate", "spectrum")
# Each a site of one page: the page, what its configuration does beside, what stops its build.
SITES = {
    "false claim": ("```{proof} davenport\n```\n", FALSE_CLAIM, "is refuted, not proved"),
    "toothless claim": (
        "```{proof} davenport\n```\n",
        TOOTHLESS_CLAIM,
        "is inconclusive, not proved",
    ),
    "stale claim": (
        "```{proof} davenport\n```\n",
        STALE_CLAIM,
        "no code is called certreg.geometry.so3.gone",
    ),
    "no such claim": ("```{proof} nonsense\n```\n", "", "the book has no claim 'nonsense'"),
    "link to none": ("{claim}`nonsense`\n", "", "the book has no claim 'nonsense'"),
    "no such work": ("As in [Nobody1999].\n", "", "[Nobody1999] is not in the bibliography"),
    "torn formula": (
        "It costs $$ a\n+ b $$ and more.\n",
        "",
        "a formula is left in the text",
    ),
    "stars": ("At every R^*, or $R*, say.\n", "", "a formula is left in the text"),
    "command fails": ("```{command} certreg info --nonsense\n```\n", "", "ended with 2, not 0"),
    "command does not": ("```{command} certreg info\n:exit: 3\n```\n", "", "ended with 0, not 3"),
    "other program": ("```{command} rm -r survey\n```\n", "", "pages run certreg"),
    "failing cell": (f"{NOTEBOOK}# Page\n\n```{{code-cell}} ipython3\n1 / 0\n```\n", "", "ZeroDiv"),
}
# What is wrong in these is seen before a page is written.
WITHOUT_HTML = set(SITES) - {"no such work"}
# One interpreter loads Sphinx, by building the first site, and forks for each other, so that none
# sees another's configuration.
BUILDER = """\
import os, pathlib, sys
from sphinx.cmd.build import main

def build(folder):
    words = os.open(folder / "words", os.O_WRONLY | os.O_CREAT)
    os.dup2(words, 1), os.dup2(words, 2)
    builder = (folder / "builder").read_text("utf-8")
    code = main(["-q", "-W", "-b", builder, str(folder), str(folder / "html")])
    (folder / "code").write_text(str(code), "utf-8")
    sys.stderr.flush()

first, *others = map(pathlib.Path, sys.argv[1:])
build(first)
for folder in others:
    if os.fork() == 0:
        build(folder)
        os._exit(0)
    os.wait()
"""


@dataclass(frozen=True, kw_only=True)
class Site:
    """A finished build: its exit code, what it said, and its pages if there are any."""

    code: int
    words: str
    pages: dict[str, str]


@pytest.fixture(scope="module")
def sites(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Site]:
    """Every site, built with warnings being errors. Seven seconds: whoever asks is `long`."""
    root = tmp_path_factory.mktemp("sites")
    folders = {name: root / name.replace(" ", "-") for name in ("claims", *SITES)}
    claims = {name: f"# Page\n\n```{{proof}} {name}\n```\n" for name in CLAIMS}
    toc = "\n".join(["# Index", "", "```{toctree}", *CLAIMS, "```", ""])
    write_site(folders["claims"], claims | {"index": toc}, "", "html")
    for name, (page, settings, _) in SITES.items():
        whole = page if page.startswith(NOTEBOOK) else f"# Page\n\n{page}"
        builder = "dummy" if name in WITHOUT_HTML else "html"  # it reads and resolves, no more
        write_site(folders[name], {"index": whole}, settings, builder)
    command = [sys.executable, "-c", BUILDER, *map(str, folders.values())]
    subprocess.run(command, check=True, cwd=DOCS.parent, stdin=subprocess.DEVNULL)
    return {name: finished(folder) for name, folder in folders.items()}


def write_site(folder: Path, pages: dict[str, str], settings: str, builder: str) -> None:
    folder.mkdir()
    conf = BUILD.format(extensions=str(DOCS / "_ext"), root=str(DOCS.parent))
    (folder / "conf.py").write_text(conf + settings, "utf-8")
    (folder / "builder").write_text(builder, "utf-8")
    listed = "".join(f"### {name}\n\n" for name in theorems())
    works = {"bibliography": BIBLIOGRAPHY, "machine-checked-proofs": THEOREMS + listed}
    for name, page in (pages | works).items():
        (folder / f"{name}.md").write_text(page, "utf-8")


def finished(folder: Path) -> Site:
    return Site(
        code=int((folder / "code").read_text("utf-8")),
        words=(folder / "words").read_text("utf-8"),
        pages={page.stem: page.read_text("utf-8") for page in folder.glob("html/*.html")},
    )


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


@pytest.mark.long
def test_a_claim_becomes_a_theorem_with_steps_and_controls(sites: dict[str, Site]):
    site = sites["claims"]
    html = site.pages["davenport"]

    assert (site.code, site.words) == (0, "")
    assert html.count('id="step-') == 3
    assert 'href="bibliography.html#cite-horn1987"' in html
    assert "K of the transpose of C" in html
    assert "PROVED" in html


@pytest.mark.long
def test_a_claim_shows_its_theorems_in_coq_as_their_files_state_them(sites: dict[str, Site]):
    html = sites["claims"].pages["eigenvectors"]
    words = markup.unescape(re.sub(r"<[^>]*>", "", html))

    assert "Not proved in Coq:" in words
    for name in book.claim("eigenvectors").coq:
        theorem = theorems()[name]
        assert theorem.statement in words
        assert f'href="machine-checked-proofs.html#{name.replace("_", "-")}"' in html
        assert all(words.count(each) >= 2 for each in theorem.hypotheses)
        assert all(axiom in words for axiom in theorem.axioms)


@pytest.mark.long
def test_a_claim_without_a_theorem_in_coq_says_so(sites: dict[str, Site]):
    assert "<strong>Not machine-checked.</strong>" in sites["claims"].pages["polar_projection"]


@pytest.mark.long
@pytest.mark.parametrize("name", ["optimality_certificate", "spectrum"])
def test_formulas_are_set_as_formulas_wherever_they_stand(sites: dict[str, Site], name: str):
    html = sites["claims"].pages[name]

    assert "$" not in re.sub(r"<pre>.*?</pre>", "", html, flags=re.DOTALL)


@pytest.mark.long
@pytest.mark.parametrize("name", SITES)
def test_what_is_wrong_stops_the_build(sites: dict[str, Site], name: str):
    assert sites[name].code != 0
    assert SITES[name][2] in sites[name].words


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


def test_a_section_of_a_docstring_is_a_heading_with_definitions(extension: Callable[[str], Any]):
    lines = [
        "Raises",
        "------",
        "KeyError, **x",
        "    Of `q`,",
        "    |q|.",
        "",
        "Examples",
        "--------",
    ]
    marked = extension("docstrings").marked_up([*lines, "", ">>> f(*x)", "1"])

    assert [line for line in marked if line] == [
        ".. rubric:: Raises",
        "``KeyError, **x``",
        "    Of ``q``,",
        r"    \|q\|.",
        ".. rubric:: Examples",
        ">>> f(*x)",
        "1",
    ]


def test_the_keys_of_a_schema_are_listed_with_their_paths(extension: Callable[[str], Any]):
    inner = {"properties": {"b": {"type": ["number", "null"], "description": "B."}}}
    schema = {"properties": {"a": {"anyOf": [inner, {"type": "null"}]}, "c": {"const": 1}}}

    assert list(extension("interface").keys_of(schema)) == [
        ("a", "anything | null", ""),
        ("a.b", "number | null", "B."),
        ("c", "1", ""),
    ]


def test_options_in_the_words_of_the_help_are_set_as_they_are_typed(
    extension: Callable[[str], Any],
):
    """In prose two hyphens become a dash, which no shell takes."""
    interface = extension("interface")
    (shown,) = interface._definitions([("--labels FILE", "Not --pose: with --max-residual. [s R]")])
    _, meaning = shown.children

    assert [node.astext() for node in meaning.findall(nodes.literal)] == [
        "--pose",
        "--max-residual",
    ]
    assert meaning.astext() == "Not --pose: with --max-residual. [s R]"
    assert (
        interface.OPTION.sub(r"`\1`", "as of --scale, x--y, `--z`")
        == "as of `--scale`, x--y, `--z`"
    )


def test_nothing_of_another_document_is_kept_with_a_page(extension: Callable[[str], Any]):
    page, other = new_document("page"), new_document("other")
    other.settings.known = "all that is known of all pages"
    stray = nodes.paragraph(text="a signature")
    stray.document = other
    page += nodes.section("", stray)
    before = pickle.dumps(page.children)
    extension("modules").forget_others(None, page)

    assert (b"all that is" in before, b"all that is" in pickle.dumps(page.children)) == (
        True,
        False,
    )
    assert all(node.document is page for node in page.findall())


def test_pages_beside_the_navigation_have_it_drawn_once_for_each_folder(
    extension: Callable[[str], Any],
):
    app = SimpleNamespace(
        env=SimpleNamespace(toctree_includes={"index": ["a/in"]}),
        config=SimpleNamespace(root_doc="index"),
    )
    keep, drawn = extension("modules").Navigation().kept, list[str]()

    def page(name: str, **options: bool) -> str:
        context = {"toctree": lambda **_: drawn.append(name) or f"as of {name}"}
        keep(app, name, "", context, None)
        return context["toctree"](**options)

    assert [page(name) for name in ("a/b", "a/c", "a/in", "index", "d/b", "a/c")] == [
        "as of a/b",
        "as of a/b",
        "as of a/in",
        "as of index",
        "as of d/b",
        "as of a/b",
    ]
    assert page("a/c", collapse=True) == "as of a/c"
    assert drawn == ["a/b", "a/in", "index", "d/b", "a/c"]
