"""HTML whose every text is escaped: a string that is not `Markup` is text, whoever wrote it."""

from __future__ import annotations

import html
import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

VOID = frozenset({"input", "meta"})  # elements that have no end


class Markup(str):
    """HTML that needs no escaping any more; made by `element` only."""

    __slots__ = ()


def element(tag: str, *children: str, **attributes: str | int | bool | None) -> Markup:
    """An element. A trailing _ of an attribute's name is dropped, other _ are hyphens.

    Attributes: True stands alone, False and None are left out.

    >>> element("a", "x < y", element("b"), class_="it's", aria_label="<", hidden=True)
    '<a class="it&#x27;s" aria-label="&lt;" hidden>x &lt; y<b></b></a>'
    """
    opened = [tag]
    for key, value in attributes.items():
        name = key.removesuffix("_").replace("_", "-")
        if value is True:
            opened.append(name)
        elif value is not None and value is not False:
            opened.append(f'{name}="{html.escape(str(value))}"')
    start = f"<{' '.join(opened)}>"
    return Markup(start if tag in VOID else f"{start}{together(children)}</{tag}>")


def together(parts: Iterable[str]) -> Markup:
    """The parts one after the other, texts among them escaped."""
    return Markup("".join(p if isinstance(p, Markup) else html.escape(p) for p in parts))


def data_block(name: str, kind: str, content: str) -> Markup:
    """A script element that is only read: no `<` of the content can end it."""
    safe = content.replace("<", r"\u003c")
    return Markup(f'<script id="{name}" type="{kind}">{safe}</script>')


def json_block(name: str, document: dict[str, Any]) -> Markup:
    """A document for the page's script, in ASCII."""
    text = json.dumps(document, allow_nan=False, separators=(",", ":"))
    return data_block(name, "application/json", text)


def asset_block(tag: str, content: str) -> Markup:
    """A script or style of certreg's own, whose content is kept to the letter: it is hashed."""
    if f"</{tag}" in content.lower() or "<!--" in content:
        message = f"the content would end its own <{tag}>"
        raise ValueError(message)
    return Markup(f"<{tag}>{content}</{tag}>")


def printable(words: object) -> str:
    r"""Words without control characters: text from a file must not steer what shows it.

    >>> print(printable("a\x1b[2J\u202eb"))
    a\x1b[2J\u202eb
    """
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in str(words))
