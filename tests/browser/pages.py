"""What is wrong with a built page that a browser opens without a network."""

from __future__ import annotations

import os
import re
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from playwright.sync_api import Page

CHROMIUM = Path(os.environ.get("CHROMIUM", "/usr/bin/chromium"))
OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-extensions"]
PATIENCE = 20_000  # milliseconds; a page takes half a second
ELSEWHERE = re.compile(r"^\s*(?:[a-z][a-z0-9+.-]*:)?//", re.IGNORECASE)
ADDRESSES = {"src", "href", "srcset", "action", "poster", "data", "formaction", "xlink:href"}
BARE = re.compile(r"\\[(\[]")  # TeX that no formula was made of
IN_STYLES = re.compile(r"(?:url\(|@import)\s*[\"']?\s*([^\"')\s;]+)")

LOADED = "() => !window.MathJax?.startup || window.MathJax.startup.promise.then(() => true)"
FORMULAS = """() => ({
  sources: document.querySelectorAll('span.math, div.math').length,
  drawn: document.querySelectorAll('.math mjx-container svg').length,
  wrong: [...document.querySelectorAll('mjx-merror, [data-mml-node="merror"]')].map(
    (node) => node.getAttribute('data-mjx-error') || node.textContent || 'unnamed'),
  bare: [...document.querySelectorAll('article p, article li, article td')].map(
    (node) => node.textContent).filter((words) => /\\\\[(\\[]/.test(words)).length,
})"""


def faults(page: Page, path: Path) -> list[str]:
    """Everything that fails while the page is opened: requests, scripts, formulas."""
    page.goto("about:blank")  # what the last page still asked for is not this one's fault
    found = list[str]()
    listeners: dict[str, Any] = {
        "requestfailed": lambda request: found.append(f"request failed: {request.url}"),
        "pageerror": lambda error: found.append(f"script failed: {error}"),
        "console": lambda message: (
            found.append(f"console: {message.text}")
            if message.type in {"error", "warning"}
            else None
        ),
    }
    for event, listener in listeners.items():
        page.on(event, listener)  # pyright: ignore[reportArgumentType, reportCallIssue]
    try:
        page.goto(path.as_uri(), wait_until="load", timeout=PATIENCE)
        page.evaluate(LOADED)
        found += _formula_faults(page.evaluate(FORMULAS))
    finally:
        for event, listener in listeners.items():
            page.remove_listener(event, listener)
    return found


def _formula_faults(seen: dict[str, Any]) -> Iterator[str]:
    for words in seen["wrong"]:
        yield f"formula error: {words}"
    if seen["drawn"] < seen["sources"]:
        yield f"{seen['sources']} formulas in the page, {seen['drawn']} drawn"
    if seen["bare"]:
        yield f"{seen['bare']} paragraphs show TeX instead of formulas"


Thing = tuple[str, ...]


class _Contents(HTMLParser):
    """Collects every address that a page names in a tag or a style, and every kind of thing in it.

    A kind of thing: a tag with its classes, what is loaded or run, a style; not words nor links. A
    formula, and what may be one, is of a kind of its own on each page.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.addresses = list[str]()
        self.things = set[Thing]()
        self._path = path
        self._within = ""  # the tag that was begun or ended last
        self._listings = 0  # open ones

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._within = tag
        self._listings += tag == "pre"
        for name, value in attrs:
            if name in ADDRESSES and value:
                self.addresses.append(value)
                if tag != "a":
                    self.things.add((tag, name, str((self._path.parent / value).resolve())))
            elif name == "style" and value:
                self.addresses += IN_STYLES.findall(value)
                self.things.add((tag, name, value))
            elif name.startswith("on"):
                self.things.add((tag, name, str(value)))
        kinds = dict(attrs).get("class") or ""
        if not (tag == "span" and self._listings):  # a word in colour
            self.things.add((tag, kinds))
        if "math" in kinds.split():
            self.things.add(("formula", str(self._path)))

    def handle_endtag(self, tag: str) -> None:
        self._within = ""
        self._listings -= tag == "pre"

    def handle_data(self, data: str) -> None:
        if self._within == "style":
            self.addresses += IN_STYLES.findall(data)
        if self._within in {"style", "script"}:
            self.things.add((self._within, data))
        elif not self._listings and BARE.search(data):
            self.things.add(("formula", str(self._path)))


@cache
def _contents(path: Path) -> _Contents:
    found = _Contents(path)
    found.feed(path.read_text("utf-8"))
    return found


def elsewhere(path: Path) -> list[str]:
    """The addresses on other hosts that an HTML or CSS file refers to, links included."""
    css = path.suffix == ".css"
    named = IN_STYLES.findall(path.read_text("utf-8")) if css else _contents(path).addresses
    return [address for address in named if ELSEWHERE.match(address)]


def covering(paths: Iterable[Path]) -> list[Path]:
    """Some of these pages, on which every kind of thing is that is on any of them.

    The others load, run and show nothing that these do not: pages of code, which one program made.
    """
    rest = {path: _contents(path).things for path in paths}
    chosen, seen = list[Path](), set[Thing]()
    while rest:
        path = max(rest, key=lambda path: len(rest[path] - seen))
        if rest[path] <= seen:
            break
        chosen.append(path)
        seen |= rest.pop(path)
    return chosen
