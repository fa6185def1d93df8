r"""The claim kernel: what is claimed, how it is proved step by step, and what must fail.

A proof is a generator of steps; each step was checked exactly when it is yielded (`algebra` makes
them). Nothing here looks at a number with a decimal point. A negative control is the same proof
about a mutated statement: it must come out refuted, or the proof would prove anything.

Trusted: this file, `algebra`, and the polynomial arithmetic of SymPy (sums and products of sparse
polynomials over the rationals). No Gröbner engine, no `simplify`, no solver.
"""

from __future__ import annotations

import enum
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from certreg.results import Ruling, Verdict

Proof = Iterable["Step"]


class Kind(enum.Enum):
    """What a step is checked by; the value is the words shown beside it."""

    IDENTITY = "both sides multiplied out are the same polynomial"
    COMBINATION = "multiplied out, a combination of expressions that vanish by hypothesis"
    POSITIVITY = "multiplied out, a sum of products of nonnegative factors"
    FACTS = "computed exactly, case by case"
    QUOTED = "a theorem from the literature, not proved here"


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One step of a proof: what it says (Markdown with LaTeX), and the verdict of its check."""

    says: str
    kind: Kind
    verdict: Verdict

    @property
    def holds(self) -> bool:
        """Whether the proof may go on: proved, or quoted with its source."""
        return self.verdict.proved or self.kind is Kind.QUOTED


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A theorem about the shipped formulas.

    statement: LaTeX within Markdown. assumptions, not_claimed: sentences. source: equation of the
    paper or bibliography key. needs: names of the claims that the proof builds on. used_by: dotted
    names of the code that relies on it. controls: mutated statement -> the proof of it. standard:
    facts of a first course (the spectral theorem, say) that its words use without a proof. coq:
    names of the theorems in `derivations/coq` that say the same or a part of it, none if no machine
    has checked it; not_in_coq: exactly what of the claim they do not say, or why there is none.
    """

    name: str
    title: str
    statement: str
    assumptions: tuple[str, ...]
    source: str
    proof: Callable[[], Proof]
    controls: Mapping[str, Callable[[], Proof]]
    not_claimed: str
    not_in_coq: str
    coq: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    used_by: tuple[str, ...] = ()
    standard: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.controls:
            raise ValueError(f"claim {self.name!r} has no negative control")


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """What became of a mutated statement: `refuted_at` is the step that failed, None if none."""

    name: str
    refuted_at: Step | None

    @property
    def passed(self) -> bool:
        """Whether the mutated proof went through, which no mutated proof may."""
        return self.refuted_at is None


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimOutcome:
    """A claim, the steps that were executed, and the verdict."""

    claim: Claim
    steps: tuple[Step, ...]
    controls: tuple[Control, ...]
    verdict: Verdict
    seconds: float

    @property
    def quoted(self) -> tuple[Step, ...]:
        """The steps that rest on the literature."""
        return tuple(step for step in self.steps if step.kind is Kind.QUOTED)


def prove(claim: Claim) -> ClaimOutcome:
    """The outcome of running a claim's proof and all its negative controls.

    PROVED if every step holds and every control is refuted; REFUTED at the first step that is not
    an identity; INCONCLUSIVE if the proof has no checked step or a control passes.
    """
    start = time.perf_counter()
    steps = _until_refuted(claim.proof())
    controls = tuple(_control(name, proof) for name, proof in claim.controls.items())
    return ClaimOutcome(
        claim=claim,
        steps=steps,
        controls=controls,
        verdict=_verdict(steps, controls),
        seconds=time.perf_counter() - start,
    )


def _until_refuted(proof: Proof) -> tuple[Step, ...]:
    steps: list[Step] = []
    for step in proof:
        steps.append(step)
        if not step.holds:
            break
    return tuple(steps)


def _control(name: str, proof: Callable[[], Proof]) -> Control:
    last = _until_refuted(proof())[-1]
    return Control(name=name, refuted_at=None if last.holds else last)


def _checked(steps: tuple[Step, ...]) -> str:
    quoted = sum(step.kind is Kind.QUOTED for step in steps)
    number = len(steps) - quoted
    words = f"{number} {'step' if number == 1 else 'steps'} checked"
    return f"{words}, {quoted} quoted" if quoted else words


def _verdict(steps: tuple[Step, ...], controls: tuple[Control, ...]) -> Verdict:
    if not any(step.kind is not Kind.QUOTED for step in steps):
        return Verdict(ruling=Ruling.INCONCLUSIVE, words="no step was checked")
    if not steps[-1].holds:
        last = steps[-1]
        return Verdict(ruling=Ruling.REFUTED, words=f"step {len(steps)}: {last.verdict.words}")
    passed = [control.name for control in controls if control.passed]
    if passed:
        words = f"the proof also proves the mutated statement: {passed[0]}"
        return Verdict(ruling=Ruling.INCONCLUSIVE, words=words)
    words = f"{_checked(steps)}, {len(controls)} mutated statements refuted"
    return Verdict(ruling=Ruling.PROVED, words=words, theorems=(steps[-1].says,))
