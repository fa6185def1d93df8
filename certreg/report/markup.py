"""Pages from templates that escape every value, whoever wrote it; what only scripts read.

The one way in which HTML is written. Jinja is loaded with the first page.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from certreg._loading import library

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

PACKAGE = "certreg"


def rendered(template: str, **values: object) -> str:
    """A page; template: its path in the package, as `report/templates/report.html`.

    A string that is not `Markup` is text. A value that the template lacks is an error.
    """
    return _environment().get_template(template).render(values)


@cache
def _environment() -> Environment:
    return environment_of(lambda name: files(PACKAGE).joinpath(name).read_text("utf-8"))


def environment_of(source: Callable[[str], str]) -> Environment:
    """What makes pages of templates; source: the text of one, by its name."""
    jinja = library("jinja2", "a page")
    environment: Environment = jinja.Environment(
        autoescape=True,
        loader=jinja.FunctionLoader(source),
        lstrip_blocks=True,
        trim_blocks=True,
        undefined=jinja.StrictUndefined,
    )
    environment.filters["coded"] = coded  # pyright: ignore[reportUnknownMemberType]  (untyped there)
    return environment


def coded(words: str) -> Markup:
    """Words in which `something` in backticks is set as code.

    >>> print(coded("a < b: see `x > y`"))
    a &lt; b: see <code>x &gt; y</code>
    """
    from markupsafe import Markup

    parts = words.split("`")
    if len(parts) % 2 == 0:
        parts[-2:] = ["`".join(parts[-2:])]  # one without a partner is a letter like others
    shown = [Markup("<code>{}</code>").format(p) if i % 2 else p for i, p in enumerate(parts)]
    return Markup("").join(shown)


def inert(content: str) -> Markup:
    """The content of a script element that is only read: no `<` of it can end the element."""
    from markupsafe import Markup

    return Markup(content.replace("<", r"\u003c"))  # noqa: S704  (no tag begins in it)


def inert_json(document: dict[str, Any]) -> Markup:
    """A document for the page's script, in ASCII."""
    return inert(json.dumps(document, allow_nan=False, separators=(",", ":")))


def asset(tag: str, content: str) -> Markup:
    """A script or style of certreg's own, whose content is kept to the letter: it is hashed."""
    from markupsafe import Markup

    if f"</{tag}" in content.lower() or "<!--" in content:
        raise ValueError(f"the content would end its own <{tag}>")
    return Markup(content)  # noqa: S704  (a file of this package, which does not end its element)


def printable(words: object) -> str:
    r"""Words without control characters: text from a file must not steer what shows it.

    >>> print(printable("a\x1b[2J\u202eb"))
    a\x1b[2J\u202eb
    """
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in str(words))
