"""`[Horn1987]` in the text of pages, docstrings and proofs becomes a link to the bibliography.

The bibliography is the page `bibliography`, made of `{entry} KEY` directives. A key that looks like
a citation and is in no entry is a warning, and so fails the build.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from docutils import nodes
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

PAGE = "bibliography"
KEY = re.compile(r"\[([A-Z][A-Za-z]+(?:18|19|20)\d\d[a-z]?)(?=\]|, )")
ENTRY = re.compile(r"^`{3,}\{entry\} +(\S+)$", re.MULTILINE)
CLOSED_TO_LINKS = (nodes.literal, nodes.literal_block, nodes.reference, nodes.math, nodes.raw)
logger = logging.getLogger(__name__)


class Entry(SphinxDirective):
    """One work: the argument is its key, the content its particulars and what it is cited for."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """A block that citations of the key lead to."""
        key = self.arguments[0]
        entry = nodes.container(ids=[target_of(key)], classes=["entry"])
        name = nodes.paragraph("", "", nodes.strong(text=key), classes=["entry-key"])
        work = nodes.container(classes=["entry-work"])
        self.state.nested_parse(self.content, self.content_offset, work)
        entry += [name, work]
        return [entry]


class LinkCitations(SphinxPostTransform):
    """Links every key of the bibliography that stands in running text."""

    default_priority = 5  # before references are resolved
    formats: ClassVar[tuple[str, ...]] = ("html",)

    def run(self, **kwargs: object) -> None:
        """Replace the keys in all text nodes of the page."""
        del kwargs
        known: frozenset[str] = self.config.bibliography_keys
        uri = self.app.builder.get_relative_uri(self.env.docname, PAGE)
        for text in list(self.document.findall(nodes.Text)):
            if _linkable(text):
                pieces = _with_links(text, known, "" if self.env.docname == PAGE else uri)
                if len(pieces) > 1:
                    text.parent.replace(text, pieces)


def _linkable(text: nodes.Text) -> bool:
    parent = text.parent
    while parent is not None:
        if isinstance(parent, CLOSED_TO_LINKS):
            return False
        parent = parent.parent
    return True


def _with_links(text: nodes.Text, known: frozenset[str], page: str) -> list[nodes.Node]:
    """The text, cut at its citations, which are links."""
    words, pieces, end = text.astext(), list[nodes.Node](), 0
    for match in KEY.finditer(words):
        key = match[1]
        if key not in known:
            logger.warning("[%s] is not in the bibliography", key, location=text.parent)
            continue
        uri = f"{page}#{target_of(key)}"
        pieces.append(nodes.Text(words[end : match.start(1)]))
        pieces.append(nodes.reference("", key, refuri=uri, internal=True, classes=["citation"]))
        end = match.end(1)
    return [*pieces, nodes.Text(words[end:])]


def target_of(key: str) -> str:
    """The identifier of an entry within the page."""
    return f"cite-{key.lower()}"


def _read_keys(app: Sphinx) -> None:
    """The keys of the bibliography, before any page is read."""
    page = Path(app.srcdir, f"{PAGE}.md")
    found = ENTRY.findall(page.read_text("utf-8")) if page.exists() else []
    app.config.bibliography_keys = frozenset(found)


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_config_value("bibliography_keys", frozenset(), "")
    app.add_directive("entry", Entry)
    app.add_post_transform(LinkCitations)
    app.connect("builder-inited", _read_keys)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
