"""A step of a proof: what it says, how it was checked, and what it asserts of polynomials."""

from __future__ import annotations

import enum
from collections.abc import Iterable
from dataclasses import InitVar, dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import sympy

from certreg.results import Ruling, Verdict

from .hypothesis import Hypothesis, Point
from .rings import symbols_of, value_at

Proof = Iterable["Step"]
_SEAL = object()  # held by `algebra` alone


class Kind(enum.Enum):
    """What a step is checked by; the value is the words shown beside it."""

    IDENTITY = "both sides multiplied out are the same polynomial"
    COMBINATION = "multiplied out, a combination of expressions that vanish by hypothesis"
    POSITIVITY = "multiplied out, a sum of products of nonnegative factors"
    STRICT = "multiplied out, a sum of products of nonnegative factors, one of them positive"
    FACTS = "computed exactly, case by case"
    CASES = "one of these always holds, by their form"
    QUOTED = "a theorem from the literature, not proved here"
    BROKEN = "the proof broke off here"


class Sense(enum.Enum):
    """What a step asserts of its polynomials; the value is the word."""

    ZERO = "0"
    NONNEGATIVE = "nonnegative"
    POSITIVE = "positive"


@dataclass(frozen=True, eq=False, kw_only=True)
class Asserted:
    """What a step asserts, where the hypotheses that it names hold: values of one sense.

    leans: the hypotheses without which the check fails. strictly: those that must say positive, or
    not zero, and not nonnegative only. sides: the two sides of an equation as
    they were given, entry by entry, to be shown.
    """

    sense: Sense
    values: tuple[Any, ...]
    named: frozenset[Hypothesis] = frozenset()
    leans: frozenset[Hypothesis] = frozenset()
    strictly: frozenset[Hypothesis] = frozenset()
    sides: tuple[tuple[Any, Any], ...] = ()

    @cached_property
    def symbols(self) -> frozenset[sympy.Symbol]:
        """The symbols of its values and of the hypotheses that it names."""
        own = frozenset[sympy.Symbol]().union(*map(symbols_of, self.values))
        return own.union(*(h.symbols for h in self.named))

    def wrong_at(self, point: Point) -> Fraction | None:
        """A value at a point that is not as asserted, evaluated exactly; None if all are."""
        for polynomial in self.values:
            value = value_at(polynomial, point)
            match self.sense:
                case Sense.ZERO:
                    wrong = value != 0
                case Sense.NONNEGATIVE:
                    wrong = value < 0
                case Sense.POSITIVE:
                    wrong = value <= 0
            if wrong:
                return value
        return None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, weakref_slot=True)
class Step:
    """One step of a proof: what it says (Markdown with LaTeX), and the verdict of its check.

    asserted: what it says of polynomials, for steps that are made of these. theorem: the name of
    what is quoted, for steps that quote. covers: conditions of which one always holds. Made by
    `algebra` alone, which holds the seal.
    """

    says: str
    kind: Kind
    verdict: Verdict
    asserted: Asserted | None = None
    theorem: str = ""
    covers: frozenset[Hypothesis] = frozenset()
    seal: InitVar[object] = None

    def __post_init__(self, seal: object) -> None:
        if seal is not _SEAL or type(self) is not Step:
            raise TypeError("steps are made by algebra alone")
        _MADE[self] = self._content

    @property
    def _content(self) -> tuple[object, ...]:
        return self.says, self.kind, self.verdict, self.asserted, self.theorem, self.covers

    @property
    def is_formula(self) -> bool:
        """Whether it says something of letters; facts and quotations do not."""
        if self.asserted is None:
            return False
        sides = (side for pair in self.asserted.sides for side in pair)
        return bool(self.asserted.symbols or any(side.free_symbols for side in sides))

    @property
    def holds(self) -> bool:
        """Whether the proof may go on: proved, or quoted with its source."""
        return self.verdict.proved or self.kind is Kind.QUOTED

    @classmethod
    def broken(cls, error: Exception) -> Step:
        """The step at which a proof ended in an exception: it proves nothing."""
        words = f"{type(error).__name__}: {error}"
        verdict = Verdict(ruling=Ruling.REFUTED, words=f"the proof broke off, {words}")
        return cls(says="The proof broke off.", kind=Kind.BROKEN, verdict=verdict, seal=_SEAL)


_MADE: WeakKeyDictionary[Step, tuple[object, ...]] = WeakKeyDictionary()


def as_made(step: object) -> bool:
    """Whether it is a step of algebra, and none that was changed since."""
    if type(step) is not Step:
        return False
    made = _MADE.get(step, ())
    content = step._content  # noqa: SLF001  (of the class above)
    return len(made) == len(content) and all(a is b for a, b in zip(made, content, strict=True))
