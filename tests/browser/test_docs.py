"""The built pages, opened in a headless browser without a network: `make test-browser`.

Every page that is for reading is opened; of those of code, which one program makes by the hundred
and which all hold the same things, as many as hold each of these.

That sets CERTREG_BROWSER. Without it no browser is started.
"""

from __future__ import annotations

import functools
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from browser.pages import CHROMIUM, covering, elsewhere, faults

if TYPE_CHECKING:
    from playwright.sync_api import Page

ROOT = Path(__file__).parents[2]
SITE = ROOT / "docs" / "_build" / "html"
REQUIRED = bool(os.environ.get("CERTREG_BROWSER"))
BUILT = sorted(SITE.rglob("*.*")) if REQUIRED else []
STYLES = [path for path in BUILT if path.suffix == ".css"]
HTML = [path for path in BUILT if path.suffix == ".html"]
REPORTS = [path for path in HTML if path.parent == SITE / "gallery"]  # no pages of Sphinx's
PAGES = [path for path in HTML if path not in REPORTS]
READ = [path for path in PAGES if not {"_modules", "modules"} & set(path.parts)]
OPENED = READ + covering(path for path in PAGES if path not in READ)
NO_THEOREM = {"index.html", "moments.html", "notation.html"}
PROOFS = [path for path in PAGES if path.parent == SITE / "proofs" and path.name not in NO_THEOREM]
MATHJAX = ROOT / "docs" / "_static" / "vendor" / "tex-svg-full.js"
NOWHERE = "https://nowhere.invalid"
site = pytest.mark.skipif(not REQUIRED, reason="drives a browser: make test-browser")


@site
def test_there_is_a_site_and_a_browser():
    assert CHROMIUM.exists()
    assert {"index.html", "search.html", "tutorial.html"} <= {path.name for path in PAGES}


THEOREM = """() => ({
  formulas: document.querySelectorAll('div.theorem span.math, div.theorem div.math').length,
  steps: document.querySelectorAll('ol.steps > li').length,
  controls: document.querySelectorAll('table.controls tbody tr').length,
})"""
VERDICT = "() => document.querySelector('.claim-verdict')?.innerText ?? ''"


@dataclass(frozen=True)
class Visit:
    """What is seen of a page while it is open; to open it takes longer than all the looking."""

    faults: list[str]
    cut_off: list[str]  # in a narrow window; only of pages that are read
    theorem: dict[str, int]  # only of pages of proofs, as the verdict
    verdict: str


def name_of(path: Path) -> str:
    return str(path.relative_to(SITE))


@functools.cache
def visited(page: Page, path: Path) -> Visit:
    found = faults(page, path)
    theorem, verdict, cut_off = dict[str, int](), "", list[str]()
    if path in PROOFS:
        theorem = page.evaluate(THEOREM)
        verdict = page.evaluate(VERDICT)
    if path in READ:
        page.set_viewport_size({"width": 400, "height": 800})
        cut_off = page.evaluate(CUT_OFF)
        page.set_viewport_size({"width": 1280, "height": 720})
    return Visit(found, cut_off, theorem, verdict)


@site
@pytest.mark.parametrize("path", OPENED, ids=map(name_of, OPENED))
def test_a_page_opens_without_network_and_without_errors(page: Page, path: Path):
    assert visited(page, path).faults == []


@site
@pytest.mark.parametrize("path", HTML + STYLES, ids=map(name_of, HTML + STYLES))
def test_a_file_refers_to_no_other_host(path: Path):
    assert elsewhere(path) == []


@site
def test_pages_of_proofs_have_formulas_and_verdicts(page: Page):
    assert PROOFS
    for path in PROOFS:
        seen = visited(page, path)
        assert min(seen.theorem.values()) > 0, path
        assert seen.verdict.upper().startswith("PROVED"), path


@site
def test_the_search_finds_a_word_without_network(page: Page):
    page.goto(f"{(SITE / 'search.html').as_uri()}?q=quaternion")

    found = page.locator("#search-results li")
    found.first.wait_for(timeout=20_000)
    assert "uaternion" in " ".join(found.all_inner_texts())


CUT_OFF = """() => {
  const edge = window.innerWidth + 1;
  if (document.documentElement.scrollWidth > edge) return ['the page'];
  return [...document.querySelectorAll('article mjx-container, article img, article code')].filter(
    (node) => node.getBoundingClientRect().right > edge && !node.closest('div.math, pre, table')
  ).map((node) => node.textContent || node.tagName);
}"""


@site
def test_a_narrow_window_cuts_nothing_off(page: Page):
    wide = {str(path.relative_to(SITE)): visited(page, path).cut_off for path in READ}

    assert len(READ) > len(PROOFS)

    assert {path: found for path, found in wide.items() if found} == {}


@site
def test_the_gallery_leads_to_reports_and_they_to_the_proofs(page: Page):
    page.goto((SITE / "gallery.html").as_uri())
    where = "a => a.map(a => a.href)"
    led = page.eval_on_selector_all("article table a", where)

    assert sorted(map(led_path, led)) == list(map(str, REPORTS))
    assert len(led) == page.locator("article table svg").count() == 14
    for path in REPORTS:
        page.goto(path.as_uri())
        proofs = page.eval_on_selector_all("#proof a", where)
        assert len(proofs) > 3
        assert all(Path(led_path(address)).exists() for address in proofs)


def led_path(address: str) -> str:
    return address.removeprefix("file://")


def planted(folder: Path, body: str) -> Path:
    """A page that loads MathJax as the site does, with something in it."""
    path = folder / "planted.html"
    settings = '{"tex": {"packages": {"[-]": ["autoload","noerrors","noundefined","require"]}}}'
    path.write_text(
        f"<!doctype html><meta charset=utf-8><script>window.MathJax = {settings}</script>"
        f'<script src="{MATHJAX.as_uri()}"></script><article>{body}</article>',
        "utf-8",
    )
    return path


def formula(tex: str) -> str:
    return rf'<p><span class="math notranslate nohighlight">\({tex}\)</span></p>'


@site
def test_a_sound_formula_is_no_fault(page: Page, tmp_path: Path):
    assert faults(page, planted(tmp_path, formula(r"q^{\mathsf T} K q"))) == []


@site
@pytest.mark.parametrize("tex", [r"\nosuchmacro{x}", r"x^2^2", r"\left( x", r"\frac{1}"])
def test_a_broken_formula_is_seen(page: Page, tmp_path: Path, tex: str):
    assert any("formula error" in fault for fault in faults(page, planted(tmp_path, formula(tex))))


@site
def test_a_formula_that_does_not_end_is_seen(page: Page, tmp_path: Path):
    found = faults(page, planted(tmp_path, formula(r"\frac{1}{")))

    assert any("drawn" in fault for fault in found)
    assert any("show TeX" in fault for fault in found)


@site
def test_a_formula_that_nobody_drew_is_seen(page: Page, tmp_path: Path):
    path = planted(tmp_path, formula("x"))
    path.write_text(path.read_text("utf-8").replace(MATHJAX.as_uri(), "about:blank"), "utf-8")

    assert any("drawn" in fault for fault in faults(page, path))


@site
@pytest.mark.parametrize(
    "body",
    [
        f'<img src="{NOWHERE}/x.png">',
        f'<script src="{NOWHERE}/x.js"></script>',
        f"<script>fetch('{NOWHERE}/x.json').catch(() => 0)</script>",
        '<img src="missing.png">',
        f"<style>p {{ background: url({NOWHERE}/x.png) }}</style><p>x</p>",
    ],
)
def test_a_request_that_fails_is_seen(page: Page, tmp_path: Path, body: str):
    assert any("request failed" in fault for fault in faults(page, planted(tmp_path, body)))


@site
def test_an_error_of_a_script_is_seen(page: Page, tmp_path: Path):
    for body in ("<script>console.error('no')</script>", "<script>throw Error('no')</script>"):
        assert faults(page, planted(tmp_path, body)) != []


@pytest.mark.parametrize(
    "body",
    [
        f'<a href="{NOWHERE}">there</a>',
        '<img src="//nowhere.invalid/x.png">',
        f"<p style=\"background: url('{NOWHERE}/x.png')\">x</p>",
        f'<style>@import "{NOWHERE}/x.css";</style>',
    ],
)
def test_an_address_on_another_host_is_seen(tmp_path: Path, body: str):
    assert elsewhere(planted(tmp_path, body)) != []


CODE = "<!doctype html><script src=a.js></script><article>%s</article><pre>%s</pre>"
OTHERS = (
    '<img src="a.png">',
    "<script>f()</script>",
    "<p onclick='f()'>a</p>",
    "<p style='color: red'>a</p>",
    "<p class='other'>a</p>",
    "<style>p { color: red }</style>",
    "<table></table>",
    r"<p>\(x\)</p>",
    r"<p>\[x\]</p>",
    "<span class='math notranslate'>x</span>",
)


def test_of_pages_that_hold_the_same_things_one_is_opened(tmp_path: Path):
    words = {"a": ("<p>one</p>", "<span class=k>if</span>"), "b": ("<p>two", r"\(x"), "c": ("", "")}
    for name, each in words.items():
        (tmp_path / f"{name}.html").write_text(CODE % each, "utf-8")

    assert [path.stem for path in covering(sorted(tmp_path.glob("*.html")))] == ["a"]


@pytest.mark.parametrize("body", OTHERS)
def test_a_page_that_holds_anything_else_is_opened(tmp_path: Path, body: str):
    for name, each in {"a": "<p>a</p>", "b": body, "c": body}.items():
        (tmp_path / f"{name}.html").write_text(CODE % (each, ""), "utf-8")
    opened = [path.stem for path in covering(sorted(tmp_path.glob("*.html")))]

    formula = "math" in body or "\\" in body
    assert "b" in opened
    assert ("c" in opened) is formula  # of formulas every page is


def test_a_page_in_another_folder_that_leads_astray_is_opened(tmp_path: Path):
    (tmp_path / "in").mkdir()
    for name, script in {"a": "a.js", "in/b": "../a.js", "in/c": "a.js"}.items():
        text = CODE.replace("a.js", script) % ("", "")
        (tmp_path / f"{name}.html").write_text(text, "utf-8")
    opened = [path.stem for path in covering(sorted(tmp_path.rglob("*.html")))]

    assert opened == ["a", "c"]
