"""A formula that was not understood as one stops the build: a dollar sign left in running text.

So does emphasis that begins right after `^` or `_`: the stars of a formula, taken for Markdown.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from docutils import nodes
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util import logging

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

NOT_PROSE = (nodes.literal, nodes.literal_block, nodes.math, nodes.math_block, nodes.raw)
logger = logging.getLogger(__name__)


class FindLeftovers(SphinxPostTransform):
    """Warns of pieces of formulas in the prose of a page."""

    default_priority = 900

    def run(self, **kwargs: object) -> None:
        """Look at every piece of text."""
        del kwargs
        for text in self.document.findall(nodes.Text):
            words = text.astext()
            if _is_prose(text) and ("$" in words or _torn(text, words)):
                logger.warning(
                    "a formula is left in the text: %s", words[:80], location=text.parent
                )


def _torn(text: nodes.Text, words: str) -> bool:
    after = text.next_node(descend=False, siblings=True)
    return words.endswith(("^", "_")) and isinstance(after, nodes.emphasis)


def _is_prose(text: nodes.Text) -> bool:
    parent = text.parent
    while parent is not None:
        if isinstance(parent, NOT_PROSE):
            return False
        parent = parent.parent
    return True


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_post_transform(FindLeftovers)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
