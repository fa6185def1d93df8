"""What is wrong with a built page that a browser opens without a network."""

from __future__ import annotations

import os
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Page

CHROMIUM = Path(os.environ.get("CHROMIUM", "/usr/bin/chromium"))
OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--disable-extensions"]
PATIENCE = 20_000  # milliseconds; a page takes half a second
ELSEWHERE = re.compile(r"^\s*(?:[a-z][a-z0-9+.-]*:)?//", re.IGNORECASE)
ADDRESSES = {"src", "href", "srcset", "action", "poster", "data", "formaction", "xlink:href"}
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


class _References(HTMLParser):
    """Collects every address that a page names in a tag or a style."""

    def __init__(self) -> None:
        super().__init__()
        self.found = list[str]()
        self._style = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._style = tag == "style"
        for name, value in attrs:
            if name in ADDRESSES and value:
                self.found.append(value)
            elif name == "style" and value:
                self.found += IN_STYLES.findall(value)

    def handle_data(self, data: str) -> None:
        if self._style:
            self.found += IN_STYLES.findall(data)


def elsewhere(path: Path) -> list[str]:
    """The addresses on other hosts that an HTML or CSS file refers to, links included."""
    text = path.read_text("utf-8")
    if path.suffix == ".css":
        named = IN_STYLES.findall(text)
    else:
        parser = _References()
        parser.feed(text)
        named = parser.found
    return [address for address in named if ELSEWHERE.match(address)]
