"""A part of a page that opens when it is asked for: details and summary of HTML."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from docutils import nodes

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata


class Disclosure(nodes.General, nodes.Element):
    """The whole; its first child is a `Summary`."""


class Summary(nodes.General, nodes.TextElement):
    """The line that is always there."""


def _visit_disclosure(translator: Any, node: nodes.Element) -> None:
    classes = " ".join(["disclosure", *node["classes"]])
    translator.body.append(f'<details class="{classes}">\n')


def _depart_disclosure(translator: Any, node: nodes.Element) -> None:
    del node
    translator.body.append("</details>\n")


def _visit_summary(translator: Any, node: nodes.Element) -> None:
    del node
    translator.body.append("<summary>")


def _depart_summary(translator: Any, node: nodes.Element) -> None:
    del node
    translator.body.append("</summary>\n")


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_node(Disclosure, html=(_visit_disclosure, _depart_disclosure))
    app.add_node(Summary, html=(_visit_summary, _depart_summary))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
