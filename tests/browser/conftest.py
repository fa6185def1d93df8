"""One browser for all tests of pages: it reaches files of this machine, and nothing else."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from browser.pages import CHROMIUM, OPTIONS

ELSEWHERE = re.compile("^(?!file:)")

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from playwright.sync_api import Browser, BrowserContext, Page


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def opened(browser: Browser) -> Callable[..., BrowserContext]:
    """A context of the browser without a network; options as Playwright names them."""

    def open_context(**options: object) -> BrowserContext:
        context = browser.new_context(
            offline=True,
            service_workers="block",
            **options,  # pyright: ignore[reportArgumentType]
        )
        # Unlike a function, a pattern is matched without asking Python about every file.
        context.route(ELSEWHERE, lambda route: route.abort())
        return context

    return open_context


@pytest.fixture(scope="module")
def page(opened: Callable[..., BrowserContext]) -> Iterator[Page]:
    context = opened()
    yield context.new_page()
    context.close()
