r"""Hypotheses: declared once for a claim, typed, and the only source of what a proof may use.

A proof may put zero for nothing but the generators of a hypothesis, and may call nothing positive
but its values. So the kernel knows what each step leans on, drops each hypothesis in turn, and
looks for an instance at which the statement is false without it.
"""

from __future__ import annotations

import enum
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy

from .rationals import rank
from .rings import flat, is_short, polynomials, value_at

Point = dict[sympy.Symbol, Fraction]
Preparation = Callable[[Point], Mapping[sympy.Symbol, Any]]


class Condition(enum.Enum):
    """What a hypothesis says of its values; the value is the word."""

    VANISHES = "vanishes"
    NONNEGATIVE = "nonnegative"
    POSITIVE = "positive"
    INVERTIBLE = "invertible"
    NONZERO = "not zero"  # a vector: one of its entries is not


class Standing(enum.Enum):
    """Where a hypothesis is in force; the value is the heading under which it is printed."""

    ASSUMED = "Assumptions"
    NOTATION = "Setting"  # what a letter stands for: nothing is assumed of the data
    CASE = "Where a step says so"  # in force in those steps only that name it


_SPACES = str.maketrans("", "", " ${}")
LINE = 100  # characters of LaTeX that fit a line
_RELATIONS = {
    Condition.VANISHES: "= 0",
    Condition.NONNEGATIVE: r"\ge 0",
    Condition.POSITIVE: "> 0",
    Condition.INVERTIBLE: r"\ne 0",
    Condition.NONZERO: r"\ne 0",
}
_INEQUALITY = re.compile(r"positive|negative|[<>]|\\(ge|le|ne|succ|succeq)\b|invertible|not zero")
_EQUALITY = re.compile(r"=|equal|same|vanish|is zero")


@dataclass(frozen=True, eq=False, kw_only=True)
class Hypothesis:
    """A hypothesis of one claim.

    says: a sentence, printed. values: the expressions that it is about. generators: what vanishes
    by it, if anything. lead: the symbol and the power that the only generator eliminates. For
    instances: prepare changes a point so that the hypothesis holds there; or it is solved for
    the symbols in `solves`, in which it is linear. further: what it says beyond its values, that a
    matrix is positive definite and not only at one vector, decided exactly at a point, and the
    symbols that this concerns besides. example: a
    point to try first where the hypothesis shall not hold; symbols that it leaves out are zero.
    """

    says: str
    form: Condition
    values: tuple[Any, ...]
    generators: tuple[Any, ...] = ()
    columns: int = 1
    standing: Standing = Standing.ASSUMED
    lead: tuple[sympy.Symbol, int] | None = None
    prepare: Preparation | None = None
    solves: tuple[sympy.Symbol, ...] = ()
    further: Callable[[Point], bool] | None = None
    concerns: tuple[sympy.Symbol, ...] = ()
    example: Mapping[sympy.Symbol, Any] = field(default_factory=dict[sympy.Symbol, Any])

    def __post_init__(self) -> None:
        if type(self) is not Hypothesis:
            raise TypeError(f"no subclass is a hypothesis: {self.says}")
        if type(self.values) is not tuple or type(self.generators) is not tuple:
            raise TypeError(f"what a hypothesis is about is a tuple: {self.says}")
        vanish = self.form is Condition.VANISHES
        if self.form is not Condition.INVERTIBLE and self.generators != self.values * vanish:
            raise ValueError(f"other expressions vanish by it than it is about: {self.says}")
        if vanish and _INEQUALITY.search(self.says) and not _EQUALITY.search(self.says):
            raise ValueError(f"an equation, and its sentence speaks of an inequality: {self.says}")

    def __getitem__(self, at: int | tuple[int, int]) -> Part:
        """One of the generators, or of the values where nothing vanishes; by row and column."""
        return Part(self, at if isinstance(at, int) else at[0] * self.columns + at[1])

    @property
    def parts(self) -> list[Part]:
        """All generators, or values, row by row."""
        return [self[k] for k in range(len(self.generators or self.values))]

    @property
    def diagonal(self) -> list[Part]:
        """Those on the diagonal of a square matrix."""
        return [self[k, k] for k in range(self.columns)]

    @property
    def formula(self) -> str:
        """What it says, made from its values; where they are too long for a line, their number."""
        every = self.generators or self.values
        relation = _RELATIONS[Condition.VANISHES if self.generators else self.form]
        distinct = [e for e in dict.fromkeys(every) if e != 0]
        shown = [sympy.latex(e) for e in distinct if is_short(e)]
        whole = r",\; ".join(f"{e} {relation}" for e in shown)
        if self.form is Condition.NONZERO:
            whole = f"({', '.join(shown)}) {relation}"
        if len(shown) == len(distinct) and len(whole) <= LINE:
            return f"${whole}$"
        number = f"{len(distinct)} expressions" if len(distinct) > 1 else "an expression"
        number += f" ${relation}$"
        least = min(shown, key=len, default="")
        return f"{number}, such as ${least} {relation}$" if 0 < len(least) <= LINE else number

    @property
    def sentence(self) -> str:
        """The words, and the formula where the words do not have it."""
        if _bare(self.formula) in _bare(self.says):
            return self.says
        return f"{self.says} As the program has it: {self.formula}."

    @cached_property
    def symbols(self) -> frozenset[sympy.Symbol]:
        """The symbols that it is about."""
        every = [*self.values, *self.generators]
        return frozenset((*self.solves, *self.concerns)).union(
            *(sympy.sympify(e).free_symbols for e in every)
        )

    @cached_property
    def equations(self) -> list[Any]:
        """The generators as polynomials."""
        return polynomials(self.generators)

    def holds_at(self, point: Point) -> bool:
        """Whether it holds at a rational point, exactly."""
        return self.values_hold(point) and (self.further is None or self.further(point))

    def values_hold(self, point: Point) -> bool:
        """Whether it holds of its values, at a rational point; `further` is left to be asked."""
        if self.generators:
            return not any(value_at(equation, point) for equation in self.equations)
        found = [value_at(value, point) for value in self._valued]
        match self.form:
            case Condition.NONNEGATIVE:
                return all(value >= 0 for value in found)
            case Condition.POSITIVE:
                return all(value > 0 for value in found)
            case Condition.NONZERO:
                return any(found)
            case _:
                return all(found)

    def fails_at(self, point: Point) -> bool:
        """Whether it does not hold at a rational point: for an inverse, that there is none."""
        if self.form is Condition.INVERTIBLE and self.standing is not Standing.NOTATION:
            found = [value_at(value, point) for value in self._valued]
            if self.generators:
                rows = [found[k : k + self.columns] for k in range(0, len(found), self.columns)]
                return rank(rows) < self.columns
        return not self.holds_at(point)

    @cached_property
    def _valued(self) -> list[Any]:
        return polynomials(self.values)


@dataclass(frozen=True, slots=True)
class Part:
    """One generator of a hypothesis, or one of its values where nothing vanishes."""

    hypothesis: Hypothesis
    index: int

    @property
    def value(self) -> Any:
        """The expression."""
        return (self.hypothesis.generators or self.hypothesis.values)[self.index]


def _bare(latex: str) -> str:
    return latex.translate(_SPACES)


def vanishing(says: str, value: Any, **further: Any) -> Hypothesis:
    """The hypothesis that expressions vanish: a number, a vector, a matrix."""
    entries = tuple(flat(value))
    columns = value.cols if isinstance(value, sympy.MatrixBase) else 1
    return Hypothesis(
        says=says,
        form=Condition.VANISHES,
        values=entries,
        generators=entries,
        columns=columns,
        **further,
    )


def equation(says: str, lead: sympy.Symbol, power: int, value: Any, **further: Any) -> Hypothesis:
    """The hypothesis that lead^power equals a value that is free of the lead."""
    return vanishing(says, lead**power - value, lead=(lead, power), **further)


def nonnegative_by(says: str, values: Any, **further: Any) -> Hypothesis:
    """The hypothesis that expressions are not negative."""
    return Hypothesis(says=says, form=Condition.NONNEGATIVE, values=tuple(flat(values)), **further)


def positive_by(says: str, values: Any, **further: Any) -> Hypothesis:
    """The hypothesis that expressions are positive."""
    return Hypothesis(says=says, form=Condition.POSITIVE, values=tuple(flat(values)), **further)


def nonzero(says: str, vector: Any, **further: Any) -> Hypothesis:
    """The hypothesis that a vector is not zero: one of its entries is not, nobody says which."""
    return Hypothesis(says=says, form=Condition.NONZERO, values=tuple(flat(vector)), **further)


def invertible(says: str, value: Any, inverse: Any = None, **further: Any) -> Hypothesis:
    """The hypothesis that a number or a square matrix is invertible, with its inverse, if named.

    Instances put the inverse for the symbols of which `inverse` is made. Without one it says that
    numbers are not zero.
    """
    entries = tuple(flat(value))
    square = isinstance(value, sympy.MatrixBase)
    if inverse is None:
        if square:
            raise TypeError(f"a vector or a matrix without its inverse; see `nonzero`: {says}")
        return Hypothesis(says=says, form=Condition.INVERTIBLE, values=entries, **further)
    solved = _letters_of_inverse(says, value, inverse)
    gone = value * inverse - (sympy.eye(value.rows) if square else 1)
    return Hypothesis(
        says=says,
        form=Condition.INVERTIBLE,
        values=entries,
        generators=tuple(flat(gone)),
        columns=value.cols if square else 1,
        solves=solved,
        **further,
    )


def _letters_of_inverse(says: str, value: Any, inverse: Any) -> tuple[sympy.Symbol, ...]:
    """The symbols that stand for an inverse, which any invertible value of this shape has.

    Each entry is its own letter. That of a symmetric matrix is symmetric, and that of a triangular
    matrix is triangular.
    """
    A = value if isinstance(value, sympy.MatrixBase) else sympy.Matrix([[value]])
    B = inverse if isinstance(inverse, sympy.MatrixBase) else sympy.Matrix([[inverse]])
    if A.rows != A.cols or A.shape != B.shape:
        raise ValueError(f"only a square matrix has an inverse, of its shape: {says}")
    n, places = A.rows, {}
    for i in range(n):
        for j in range(n):
            places.setdefault(B[i, j], []).append((i, j))
    gone = places.pop(sympy.Integer(0), [])
    same = any(len(where) > 1 for where in places.values())
    letters = all(isinstance(entry, sympy.Symbol) for entry in places)
    if not letters or places.keys() & A.free_symbols:
        raise ValueError(f"each entry of an inverse is its own letter: {says}")
    if same and not (A.is_symmetric() and B.is_symmetric() and len(places) == n * (n + 1) // 2):
        raise ValueError(f"each entry of an inverse is its own letter: {says}")
    sides = {i < j for i, j in gone}
    if gone and not (sides in ({True}, {False}) and all(i != j and A[i, j] == 0 for i, j in gone)):
        raise ValueError(f"entries of an inverse that need not be zero: {says}")
    if gone and len(gone) < n * (n - 1) // 2:
        raise ValueError(f"entries of an inverse that need not be zero: {says}")
    return tuple(sorted(places, key=str))


def printed(hypotheses: Sequence[Hypothesis], standing: Standing) -> tuple[str, ...]:
    """The sentences of that standing, each once: the words, and the formula that is checked."""
    said = (h.sentence for h in hypotheses if h.standing is standing)
    return tuple(dict.fromkeys(said))
