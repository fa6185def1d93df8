"""`{claims}`: all claims by chapter. `{audit}`: the paper's claims. The role `{claim}`: a link."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from docutils import nodes
from proofs import FOLDER, MarkdownDirective, outcomes_of, table
from sphinx import addnodes
from sphinx.errors import ExtensionError
from sphinx.util import logging
from sphinx.util.docutils import SphinxRole

from derivations import audit, book

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

logger = logging.getLogger(__name__)


FACTS = (
    "verdict",
    "steps",
    "quoted",
    "hypotheses",
    "controls",
    "coq",
)  # of `summary_of`, in columns


class PlaceOfClaims(nodes.General, nodes.Element):
    """Where the table of all claims goes once every page has been read."""


class Claims(MarkdownDirective):
    """The index of all claims, and the place of their pages in the table of contents."""

    def run(self) -> list[nodes.Node]:
        """A table to be filled, and a hidden list of the pages."""
        pages = [f"{title_of(name)} <{name}>" for name in book.names()]
        listed = "\n".join(["```{toctree}", ":hidden:", "", *pages, "```"])
        return [PlaceOfClaims(), *self.markdown(listed)]


class Audit(MarkdownDirective):
    """The audit of the paper; every counterexample is computed anew.

    With the argument `springs`: what becomes of its conjecture where springs are matrices.
    """

    optional_arguments = 1

    def run(self) -> list[nodes.Node]:
        """A table, one row for each claim of the paper."""
        header = [nodes.paragraph(text=word) for word in ("", "the paper's claim", "what holds")]
        rows = audit.carried_over() if self.arguments == ["springs"] else audit.rows()
        return [table(header, map(self._row, rows), (7, 36, 57), "audit")]

    def _row(self, row: audit.Row) -> list[nodes.Node]:
        claim = nodes.container("", nodes.paragraph(text=row.claim))
        claim += nodes.paragraph(text=row.place, classes=["place"])
        kind = row.finding.name.lower().replace("_", "-")
        finding = nodes.paragraph(text=row.finding.value, classes=["finding", kind])
        holds = nodes.container("", finding, nodes.paragraph(text=row.holds))
        if row.counterexample is not None:
            verdict = row.recheck()
            if not verdict.proved:
                raise ExtensionError(f"audit, row {row.number}: {verdict.words}")
            label = nodes.emphasis(text="Counterexample: ")
            holds += nodes.paragraph("", "", label, nodes.Text(f"{row.counterexample.words}."))
        holds += self.prose("*Proof:* " + ", ".join(f"{{claim}}`{name}`" for name in row.because))
        return [nodes.paragraph(text=row.number, ids=[f"row-{row.number}"]), claim, holds]


class ClaimLink(SphinxRole):
    """`{claim}`NAME`` or `{claim}`words <NAME>``: a link to the page of a claim."""

    def run(self) -> tuple[list[nodes.Node], list[nodes.system_message]]:
        """The link; a claim that the book lacks is a warning, or plain words in a draft."""
        words, _, name = self.text.partition(" <")
        name = name.removesuffix(">") or words
        if name not in book.names():
            if not self.config.draft:
                logger.warning("the book has no claim %r", name, location=self.get_location())
            return [nodes.inline(text=words)], []
        link = addnodes.pending_xref(
            "",
            nodes.inline(text=title_of(name) if words == name else words),
            refdomain="std",
            reftype="doc",
            reftarget=f"/{FOLDER}/{name}",
            refdoc=self.env.docname,
            refexplicit=True,
        )
        return [link], []


def title_of(name: str) -> str:
    """The title of a claim."""
    return book.claim(name).title


def _fill(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    """Put the verdicts of all claims into the index."""
    for place in list(doctree.findall(PlaceOfClaims)):
        shown = [node for c in book.CHAPTERS for node in _chapter(app, docname, c)]
        place.replace_self(shown)


def _chapter(app: Sphinx, docname: str, chapter: book.Chapter) -> list[nodes.Node]:
    head = (
        "claim",
        "verdict",
        "steps",
        "quoted",
        "hypotheses needed",
        "controls refuted",
        "theorems in Coq",
    )
    rows = [_row(app, docname, name) for name in chapter.names]
    header = [nodes.paragraph(text=word) for word in head]
    shown = table(header, rows, (32, 12, 9, 9, 14, 12, 12), "claims")
    return [nodes.rubric(text=chapter.title), shown]


def _row(app: Sphinx, docname: str, name: str) -> list[nodes.Node]:
    outcome: dict[str, Any] = outcomes_of(app.env).get(name, {})
    if not outcome:
        logger.warning("no page proves the claim %r", name, location=docname)
    uri = app.builder.get_relative_uri(docname, f"{FOLDER}/{name}")
    link = nodes.reference("", title_of(name), refuri=uri, internal=True)
    words = [str(outcome.get(key, "")) for key in FACTS]
    return [nodes.paragraph("", "", link), *(nodes.paragraph(text=word) for word in words)]


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_config_value("draft", default=False, rebuild="env")
    app.add_node(PlaceOfClaims)
    app.add_directive("claims", Claims)
    app.add_directive("audit", Audit)
    app.add_role("claim", ClaimLink())
    app.connect("doctree-resolved", _fill)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
