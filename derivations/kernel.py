r"""The claim kernel: what is claimed, how it is proved step by step, and what must fail.

A proof is a generator of steps; each step was checked exactly when it is yielded (`algebra` makes
them). Nothing here looks at a number with a decimal point.

Two things must fail, or the proof would prove anything. A hypothesis is dropped: a step that leans
on it fails, and at an instance of all other hypotheses the statement is false. The statement is
mutated: the same proof fails at the step that is told, and the mutated statement is false at an
instance. Instances are rational points, evaluated exactly.

Trusted: this file, `steps`, `hypothesis`, `algebra`, `rings`, and the polynomial arithmetic of
SymPy (sums and products of sparse polynomials over the rationals). No Gröbner engine, no
`simplify`, no solver: `instances` proposes points, and they are evaluated.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import sympy

from certreg.results import Ruling, Verdict

from .hypothesis import Condition, Hypothesis, Standing, printed
from .instances import counterexample, witness
from .notation_rules import no_notation
from .steps import Kind, Proof, Step, as_made


@dataclass(frozen=True, slots=True, kw_only=True)
class Mutation:
    """The proof of a mutated statement, which is false: `at` is the step that must fail.

    Where that step says, of the mutated formulas, a part of the statement itself, the kernel finds
    a point at which it is false; point: one to try first, symbols left out are zero. Otherwise,
    instance: a step that shows the mutated statement false at exact numbers.
    """

    at: int
    proof: Callable[[], Proof]
    point: Mapping[sympy.Symbol, Any] = field(default_factory=dict[sympy.Symbol, Any])
    instance: Callable[[], Step] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A theorem about the shipped formulas.

    statement: LaTeX within Markdown. concludes: the numbers of those steps that say it, or a part
    of it, in formulas. hypotheses: all that its proof may use. inherits: claims that the words of
    its proof build on, and whose assumptions it makes with them. setting: sentences on what the
    letters stand for. not_claimed: sentences. source: equation of the paper or bibliography key.
    needs: names of the claims that the proof builds on. runs: dotted names of the functions that
    the proof itself runs, with symbols or case by case: what is proved is proved of this code.
    used_by: of other code that relies on it; that link is tested, and not proved. controls: name of
    a mutated statement -> its proof. standard: facts of a first course (the spectral theorem, say)
    that its words use without a proof. witness: a point to try first at which its hypotheses hold
    together; symbols left out are zero. coq: names of the theorems in `derivations/coq` that say
    the same or a part of it, none if no machine has checked it; not_in_coq: exactly what of the
    claim they do not say, or why there is none.
    """

    name: str
    title: str
    statement: str
    concludes: tuple[int, ...]
    source: str
    proof: Callable[[], Proof]
    controls: Mapping[str, Mutation]
    not_claimed: str
    not_in_coq: str
    hypotheses: tuple[Hypothesis, ...] = ()
    inherits: tuple[Claim, ...] = ()
    setting: tuple[str, ...] = ()
    coq: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    runs: tuple[str, ...] = ()
    used_by: tuple[str, ...] = ()
    standard: tuple[str, ...] = ()
    witness: Mapping[sympy.Symbol, Any] = field(default_factory=dict[sympy.Symbol, Any])

    def __post_init__(self) -> None:
        if not self.controls:
            raise ValueError(f"claim {self.name!r} has no negative control")
        if not self.concludes:
            raise ValueError(f"claim {self.name!r} does not say which steps are its statement")
        if min(self.concludes) < 1:
            raise ValueError(f"claim {self.name!r}: steps are counted from 1")
        if type(self.hypotheses) is not tuple:
            raise TypeError(f"claim {self.name!r}: its hypotheses are a tuple")

    @property
    def assumed(self) -> tuple[str, ...]:
        """What is assumed, in words: by the hypotheses, and by those of the claims it inherits."""
        own = printed(self.hypotheses, Standing.ASSUMED)
        others = (sentence for claim in self.inherits for sentence in claim.assumed)
        return tuple(dict.fromkeys((*own, *others)))

    @property
    def assumptions(self) -> tuple[str, ...]:
        """The same, to be printed: it says so where nothing is assumed."""
        return self.assumed or ("None.",)

    @property
    def premises(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """Headings and sentences: what is assumed, what letters stand for, what holds in places."""
        said = {standing: printed(self.hypotheses, standing) for standing in Standing}
        said[Standing.ASSUMED] = self.assumptions
        said[Standing.NOTATION] = (*self.setting, *said[Standing.NOTATION])
        return tuple((standing.value, words) for standing, words in said.items() if words)


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """What became of a mutated statement.

    refuted_at: the step that failed, None if none. number: its number. words: the instance at
    which the mutated statement is false. complaint: why this is no refutation of the mutated
    statement; empty if it is one.
    """

    name: str
    refuted_at: Step | None
    number: int
    words: str = ""
    complaint: str = ""

    @property
    def refuted(self) -> bool:
        """Whether the proof failed where it must, and the statement is false at an instance."""
        return not self.complaint


@dataclass(frozen=True, slots=True, kw_only=True)
class Dropped:
    """What became of the proof without a hypothesis.

    number: the step that fails without it. words: the instance at which the statement is false
    then. complaint: why the hypothesis is not shown to be needed; empty if it is.
    """

    hypothesis: Hypothesis
    number: int
    words: str = ""
    complaint: str = ""

    @property
    def needed(self) -> bool:
        """Whether the proof fails without it, and the statement is false at an instance."""
        return not self.complaint


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimOutcome:
    """A claim, the steps that were executed, what had to fail, and the verdict."""

    claim: Claim
    steps: tuple[Step, ...]
    dropped: tuple[Dropped, ...]
    controls: tuple[Control, ...]
    verdict: Verdict
    seconds: float

    @property
    def quoted(self) -> tuple[Step, ...]:
        """The steps that rest on the literature."""
        return tuple(step for step in self.steps if step.kind is Kind.QUOTED)

    @property
    def modulo(self) -> str:
        """To be put after the verdict: the theorems that the proof quotes; empty if it has none."""
        theorems = dict.fromkeys(step.theorem for step in self.quoted)
        return f", modulo {' and '.join(theorems)}" if self.verdict.proved and theorems else ""


def prove(claim: Claim) -> ClaimOutcome:
    """The outcome of running a claim's proof, without each hypothesis too, and its controls.

    PROVED if every step holds, every hypothesis is needed and every control refuted; REFUTED at the
    first step that does not hold, or that broke off; INCONCLUSIVE if the proof has no checked step,
    uses a hypothesis that is not declared, does not need one that is, or a control passes.
    """
    start = time.perf_counter()
    steps = until_refuted(claim.proof)
    dropped: tuple[Dropped, ...] = ()
    if steps and steps[-1].holds:
        dropped = tuple(_without(h, claim, steps) for h in claim.hypotheses)
    controls = tuple(_control(name, claim, steps) for name in claim.controls)
    return ClaimOutcome(
        claim=claim,
        steps=steps,
        dropped=dropped,
        controls=controls,
        verdict=_verdict(claim, steps, dropped, controls),
        seconds=time.perf_counter() - start,
    )


def until_refuted(proof: Callable[[], Proof]) -> tuple[Step, ...]:
    """The steps up to the first that does not hold; what is raised is a step that does not."""
    steps: list[Step] = []
    try:
        for step in proof():
            if not as_made(step):
                raise TypeError("it is no step of algebra")  # noqa: TRY301  (as all that is raised)
            steps.append(step)
            if not step.holds:
                break
    except Exception as error:  # noqa: BLE001  (whatever breaks a proof, it proves nothing then)
        steps.append(Step.broken(error))
    return tuple(steps)


def _without(hypothesis: Hypothesis, claim: Claim, steps: Sequence[Step]) -> Dropped:
    """The proof without a hypothesis: the step that fails, and an instance of the rest."""
    leaning = [
        (number, step)
        for number, step in enumerate(steps, 1)
        if step.asserted is not None and hypothesis in step.asserted.leans
    ]
    if not leaning:
        complaint = "no step needs it"
        return Dropped(hypothesis=hypothesis, number=0, complaint=complaint)
    first = leaning[0][0]
    strict = [pair for pair in leaning if _strict(pair[1], hypothesis)]
    if hypothesis.form is Condition.POSITIVE and not strict:
        complaint = "every step would do with nonnegative"
        return Dropped(hypothesis=hypothesis, number=first, complaint=complaint)
    for number, step in strict + [pair for pair in leaning if pair not in strict]:
        if number in claim.concludes and step.asserted is not None:
            found = counterexample(
                step.asserted, claim.hypotheses, hypothesis, first=hypothesis.example
            )
            if found is not None:
                return Dropped(hypothesis=hypothesis, number=number, words=found.words)
    complaint = "no instance shows the statement false without it"
    return Dropped(hypothesis=hypothesis, number=first, complaint=complaint)


def _strict(step: Step, hypothesis: Hypothesis) -> bool:
    return step.asserted is not None and hypothesis in step.asserted.strictly


def _control(name: str, claim: Claim, own: Sequence[Step]) -> Control:
    """The proof of a mutated statement: it fails where it must, and an instance shows why."""
    mutation = claim.controls[name]
    steps = until_refuted(mutation.proof)
    number, last = len(steps), steps[-1] if steps else Step.broken(ValueError("no step"))
    if last.holds:
        return Control(name=name, refuted_at=None, number=0, complaint="the proof also proves this")
    words, complaint = "", ""
    if last.kind is Kind.BROKEN:
        complaint = last.verdict.words
    elif number != mutation.at or number > len(own):
        complaint = f"it fails at step {number}, not at step {mutation.at}"
    elif mutation.instance is not None:
        instance = mutation.instance()
        words = instance.says
        if not (instance.verdict.proved and instance.kind is Kind.FACTS):
            complaint = f"its instance is none: {instance.verdict.words}"
    elif number not in claim.concludes:
        complaint = f"step {number} is not what is claimed, and there is no instance"
    elif last.asserted is None:
        words = last.verdict.words  # facts: exact values, not as told
    else:
        found = counterexample(last.asserted, claim.hypotheses, first=mutation.point)
        words = found.words if found else ""
        complaint = "" if found else "no instance shows it false"
    return Control(name=name, refuted_at=last, number=number, words=words, complaint=complaint)


def _checked(steps: Sequence[Step]) -> str:
    quoted = sum(step.kind is Kind.QUOTED for step in steps)
    words = _count(len(steps) - quoted, "step") + " checked"
    return f"{words}, {quoted} quoted" if quoted else words


def _count(number: int, noun: str) -> str:
    plural = f"{noun[:-2]}es" if noun.endswith("is") else f"{noun}s"
    return f"{number} {noun if number == 1 else plural}"


def _verdict(
    claim: Claim,
    steps: Sequence[Step],
    dropped: Sequence[Dropped],
    controls: Sequence[Control],
) -> Verdict:
    if not any(step.kind is not Kind.QUOTED for step in steps):
        return Verdict(ruling=Ruling.INCONCLUSIVE, words="no step was checked")
    if not steps[-1].holds:
        words = f"step {len(steps)}: {steps[-1].verdict.words}"
        return Verdict(ruling=Ruling.REFUTED, words=words)
    complaint = _complaint(claim, steps, dropped, controls)
    if complaint:
        return Verdict(ruling=Ruling.INCONCLUSIVE, words=complaint)
    words = f"{_checked(steps)}, {_count(len(controls), 'mutated statement')} refuted"
    if dropped:
        words += f", {_count(len(dropped), 'hypothesis')} needed"
    return Verdict(ruling=Ruling.PROVED, words=words, tell=partial(tuple, (steps[-1].says,)))


def _complaint(
    claim: Claim,
    steps: Sequence[Step],
    dropped: Sequence[Dropped],
    controls: Sequence[Control],
) -> str:
    """Why a proof whose steps all hold is none of the claim; empty if it is one."""
    for number, step in enumerate(steps, 1):
        used = step.asserted.named if step.asserted is not None else frozenset[Hypothesis]()
        undeclared = [h.says for h in used | step.covers if h not in claim.hypotheses]
        if undeclared:
            return f"step {number} uses what the claim does not assume: {undeclared[0]}"
    if max(claim.concludes) > len(steps):
        return f"there is no step {max(claim.concludes)}, which was to say the claim"
    for drop in dropped:
        if not drop.needed:
            return f"the hypothesis {drop.hypothesis.says!r}: {drop.complaint}"
    for control in controls:
        if not control.refuted:
            return f"the mutated statement {control.name!r}: {control.complaint}"
    return _unsaid(claim, steps) or no_notation(claim.hypotheses) or _unmet(claim, steps)


def _unsaid(claim: Claim, steps: Sequence[Step]) -> str:
    """Why the steps that are told to say the claim do not: facts, or what holds in a case only."""
    concluded = [steps[number - 1] for number in claim.concludes]
    formulas = [step.asserted.named for step in concluded if step.asserted and step.is_formula]
    if not formulas:
        return "no formula of letters is among the steps that say the claim"
    covered = frozenset[Hypothesis]().union(*(step.covers for step in steps))
    if all(any(h.standing is Standing.CASE for h in named - covered) for named in formulas):
        return "what is claimed is shown in a case only, and no step says that the cases cover"
    return ""


def _unmet(claim: Claim, steps: Sequence[Step]) -> str:
    """What cannot hold together, of all hypotheses in force or of those that a step names."""
    everywhere = frozenset(h for h in claim.hypotheses if h.standing is not Standing.CASE)
    named = [step.asserted.named for step in steps if step.asserted is not None]
    order = {h: k for k, h in enumerate(claim.hypotheses)}
    for together in dict.fromkeys([everywhere, *(everywhere | some for some in named)]):
        if together and witness(sorted(together, key=order.__getitem__), claim.witness) is None:
            words = "; ".join(
                h.says.removesuffix(".") for h in sorted(together, key=order.__getitem__)
            )
            return f"no point at which these hold together was found: {words}"
    return ""
