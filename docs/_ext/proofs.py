"""`{proof} NAME` runs a claim's proof while the page is built, and writes down what was executed.

Nothing on the page is written by hand but the prose around it: statement, steps, checks, negative
controls and the code come from the claim and from the run. A claim that is not PROVED stops the
build.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from disclosure import Disclosure, Summary
from docutils import nodes
from docutils.statemachine import StringList
from listings import listing
from sphinx.errors import ExtensionError
from sphinx.util.docutils import SphinxDirective

from derivations import book
from derivations.coq.theorems import Theorem, theorems
from derivations.kernel import Claim, ClaimOutcome, Control, prove
from derivations.latex import compared
from derivations.steps import Kind, Step

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.environment import BuildEnvironment
    from sphinx.util.typing import ExtensionMetadata

FOLDER = "proofs"  # the page of a claim is FOLDER/NAME
NO_CODE = "No code: it is a step of the chain."
RUN = (
    "The proof runs these functions, with symbols or case by case: what is proved, is of this code."
)
RELYING = "This code relies on it. That it does what is proved is tested, and not proved."
MACHINE = "/machine-checked-proofs.md"
IN_COQ = (
    "Proved a second time, by other means, as statements that Coq's kernel has accepted. [The page "
    f"of all theorems]({MACHINE}) says what their words and the axioms mean; the axioms are those "
    "of Coq's own library of real numbers."
)
DISPLAYED = re.compile(r"\s*\$\$(.+?)\$\$\s*", re.DOTALL)


class MarkdownDirective(SphinxDirective):
    """A directive that renders Markdown which it has made or been given."""

    def markdown(self, text: str) -> list[nodes.Node]:
        """The nodes of a piece of Markdown. A displayed formula is a block, wherever it stands."""
        holder = nodes.container()
        blocks = DISPLAYED.sub(lambda found: f"\n\n$$\n{found[1].strip()}\n$$\n\n", text)
        lines = StringList(blocks.strip().splitlines(), source=self.get_source_info()[0])
        self.state.nested_parse(lines, self.content_offset, holder)
        return holder.children

    def prose(self, text: str, *classes: str) -> nodes.container:
        """A block of Markdown."""
        return nodes.container("", *self.markdown(text), classes=list(classes))

    def section(self, title: str, *content: nodes.Node) -> nodes.section:
        """A section of the page, that its table of contents shows."""
        section = nodes.section("", nodes.title(text=title), *content, names=[title.lower()])
        self.state.document.note_implicit_target(section, section)
        return section


class Proof(MarkdownDirective):
    """The theorem of a claim, its executed proof, and what must fail."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Prove the claim and render it."""
        name = self.arguments[0]
        try:
            claim = book.claim(name)
        except KeyError as error:
            raise ExtensionError(f"{self.env.docname}: the book has no claim {name!r}") from error
        outcome = prove(claim)
        if not outcome.verdict.proved:
            ruling, words = outcome.verdict.ruling.value, outcome.verdict.words
            raise ExtensionError(f"claim {name!r} is {ruling}, not proved: {words}")
        outcomes_of(self.env)[name] = summary_of(outcome)
        return [
            *self._statement(claim),
            self.section(
                "Proof", self._steps(outcome.steps), self._verdict(outcome), _source(claim)
            ),
            self.section("What must fail, and does", *self._failing(outcome)),
            self.section("Checked by machine, in Coq", *self._in_coq(claim)),
            self.section("What is not claimed", self.prose(claim.not_claimed)),
            self.section("The code that uses it", *self._code(claim)),
        ]

    def prose(self, text: str, *classes: str) -> nodes.container:
        """A block of Markdown in which the names of claims are links."""
        block = super().prose(text, *classes)
        self._link_claims(block)
        return block

    def _statement(self, claim: Claim) -> list[nodes.Node]:
        heading = nodes.paragraph("", "", nodes.strong(text=f"Theorem ({claim.title})."))
        box = nodes.container("", heading, *self.markdown(claim.statement), classes=["theorem"])
        self._link_claims(box)
        facts = nodes.field_list(classes=["claim-facts"])
        for heading, sentences in claim.premises:
            facts += _field(heading, *map(self.prose, sentences))
        facts += _field("Said in formulas", _places(claim.concludes))
        facts += _field("Source", self.prose(claim.source))
        if claim.needs:
            facts += _field("Needs", self._links(claim.needs))
        if claim.standard:
            facts += _field("Uses, not proved here", *map(self.prose, claim.standard))
        needed = [other.name for other in book.claims() if claim.name in other.needs]
        if needed:
            facts += _field("Needed by", self._links(needed))
        return [box, facts]

    def _links(self, names: Iterable[str]) -> nodes.container:
        return self.prose(", ".join(f"{{claim}}`{name}`" for name in names))

    def _steps(self, steps: Iterable[Step]) -> nodes.enumerated_list:
        shown = nodes.enumerated_list(classes=["steps"])
        for number, step in enumerate(steps, 1):
            item = nodes.list_item(ids=[f"step-{number}"], classes=[step.kind.name.lower()])
            item += self.markdown(step.says)
            self._link_claims(item)
            item += self._check(step)
            shown += item
        return shown

    def _check(self, step: Step) -> list[nodes.Node]:
        """How a step was checked, or that it was not."""
        if step.kind is Kind.QUOTED:
            words = f"**quoted** {step.kind.value}: {step.verdict.words}."
        else:
            words = f"**checked** {step.kind.value} ({step.verdict.words})."
            words += f" As the program has it: {shown}." if (shown := compared(step)) else ""
        lines = self.markdown(words)
        for line in lines:
            if isinstance(line, nodes.paragraph):
                line["classes"].append("check")
        return lines

    def _link_claims(self, prose: nodes.Element) -> None:
        """Lead from the name of another claim, set as code, to its page."""
        names = book.names()
        for code in list(prose.findall(nodes.literal)):
            if code.astext() in names:
                link = self._links([code.astext()])
                code.parent.replace(code, list(link.children[0].children))

    def _verdict(self, outcome: ClaimOutcome) -> nodes.paragraph:
        words = f" {outcome.verdict.words}."
        ruling = nodes.strong(text=outcome.verdict.ruling.value.upper() + outcome.modulo)
        return nodes.paragraph("", "", ruling, nodes.Text(words), classes=["claim-verdict"])

    def _failing(self, outcome: ClaimOutcome) -> list[nodes.Node]:
        """The hypotheses, each left out, and the mutated statements."""
        opening = (
            "Mutated statements: the same proof, with another formula in its place, fails at the "
            "step named, and the mutated statement is false at the instance. Had one of them come "
            "out as proved, or had no instance been found, this page would not exist."
        )
        rows = [self._control(control, outcome) for control in outcome.controls]
        header = _header("mutated", "refuted at", "false at the instance")
        found = [nodes.paragraph(text=opening), table(header, rows, (30, 15, 55), "controls")]
        return [*self._without(outcome), *found]

    def _without(self, outcome: ClaimOutcome) -> list[nodes.Node]:
        """What fails without each hypothesis; nothing where none is made."""
        if not outcome.dropped:
            return []
        opening = (
            "Hypotheses: without any one of them the step named fails, and it is false at the "
            "instance, at which all others hold."
        )
        rows = [
            [self.prose(drop.hypothesis.says), _places([drop.number]), _instance(drop.words)]
            for drop in outcome.dropped
        ]
        header = _header("left out", "step", "false at the instance")
        return [nodes.paragraph(text=opening), table(header, rows, (30, 15, 55), "hypotheses")]

    def _control(self, control: Control, outcome: ClaimOutcome) -> list[nodes.Node]:
        if not control.refuted:  # `prove` would not have said PROVED
            raise ExtensionError(f"{outcome.claim.name}: {control.name!r}: {control.complaint}")
        words = self.prose(control.words) if "$" in control.words else _instance(control.words)
        return [self.prose(control.name), _places([control.number]), words]

    def _in_coq(self, claim: Claim) -> list[nodes.Node]:
        """The theorems in Coq beside the claim, as their files state them, and what they lack."""
        if not claim.coq:
            return [self.prose(f"**Not machine-checked.** {claim.not_in_coq}")]
        shown = [part for name in claim.coq for part in self._theorem(theorems()[name])]
        return [
            self.prose(f"{IN_COQ}\n\n**Not proved in Coq:** {claim.not_in_coq}", "not-in-coq"),
            *shown,
        ]

    def _theorem(self, theorem: Theorem) -> list[nodes.Node]:
        prose = self.prose(f"[`{theorem.name}`]({MACHINE}#{theorem.name}): {theorem.prose}")
        facts = nodes.field_list(classes=["claim-facts"])
        hypotheses = "; ".join(f"`{each}`" for each in theorem.hypotheses) or "none"
        facts += _field("Hypotheses", self.prose(hypotheses))
        axioms = ", ".join(f"`{axiom}`" for axiom in theorem.axioms) or "none"
        facts += _field("Axioms", self.prose(axioms))
        code = nodes.literal_block(theorem.statement, theorem.statement, language="coq")
        return [nodes.container("", prose, code, facts, classes=["in-coq"])]

    def _code(self, claim: Claim) -> list[nodes.Node]:
        shown: list[nodes.Node] = []
        for words, names in ((RUN, claim.runs), (RELYING, claim.used_by)):
            if names:
                listed = [listing(dotted, self.env.docname) for dotted in names]
                shown += [nodes.paragraph(text=words), *listed]
        return shown or [nodes.paragraph(text=NO_CODE)]


def _source(claim: Claim) -> Disclosure:
    """The file of the claim, to be opened."""
    file = Path(inspect.getfile(claim.proof))
    text = file.read_text("utf-8")
    summary = Summary("", "The program that is this proof: ", nodes.literal(text=file.name))
    return Disclosure("", summary, nodes.literal_block(text, text, language="python"))


def _places(numbers: Iterable[int]) -> nodes.paragraph:
    """Links to steps."""
    links = [nodes.reference("", str(number), refid=f"step-{number}") for number in numbers]
    shown: list[nodes.Node] = [nodes.Text("step " if len(links) == 1 else "steps ")]
    for k, link in enumerate(links):
        shown += [nodes.Text(", "), link] if k else [link]
    return nodes.paragraph("", "", *shown)


def _instance(words: str) -> nodes.paragraph:
    """A point and a value, set as what they are: code."""
    return nodes.paragraph("", "", nodes.literal(text=words), classes=["rest"])


def _header(*words: str) -> list[nodes.paragraph]:
    return [nodes.paragraph(text=each) for each in words]


def _field(name: str, *content: nodes.Node) -> nodes.field:
    return nodes.field("", nodes.field_name(text=name), nodes.field_body("", *content))


def table(
    header: Iterable[nodes.Node],
    rows: Iterable[Iterable[nodes.Node]],
    widths: tuple[int, ...],
    *classes: str,
) -> nodes.table:
    """A table with a header; `widths` in per cent."""
    group = nodes.tgroup(cols=len(widths))
    group += [nodes.colspec(colwidth=width) for width in widths]
    group += nodes.thead("", _row(header))
    group += nodes.tbody("", *map(_row, rows))
    return nodes.table("", group, classes=["colwidths-given", *classes])


def _row(cells: Iterable[nodes.Node]) -> nodes.row:
    return nodes.row("", *(nodes.entry("", cell) for cell in cells))


Facts = dict[str, Any]


def summary_of(outcome: ClaimOutcome) -> Facts:
    """What the index of all claims says of one; no times, so that a build can be repeated."""
    return {
        "verdict": outcome.verdict.ruling.value + outcome.modulo,
        "steps": len(outcome.steps),
        "quoted": len(outcome.quoted),
        "controls": len(outcome.controls),
        "hypotheses": len(outcome.dropped),
        "coq": len(outcome.claim.coq),
    }


def outcomes_of(env: BuildEnvironment) -> dict[str, Facts]:
    """The claims that the pages have proved so far, by name."""
    if not hasattr(env, "certreg_outcomes"):
        env.certreg_outcomes = {}  # pyright: ignore[reportAttributeAccessIssue]
    return env.certreg_outcomes  # pyright: ignore[reportAttributeAccessIssue]


def _merge(app: Sphinx, env: BuildEnvironment, docnames: set[str], other: BuildEnvironment) -> None:
    del app, docnames
    outcomes_of(env).update(outcomes_of(other))


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_directive("proof", Proof)
    app.connect("env-merge-info", _merge)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
