"""False statements, each with a proof that an attacker of the kernel might write: all refused.

A refusal is a verdict that is not PROVED, or an exception where the proof or its parts are made.
"""

from __future__ import annotations

import dataclasses
import enum
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import sympy

from certreg.results import Ruling, Verdict
from derivations import algebra, instances
from derivations.algebra import Square
from derivations.hypothesis import (
    Condition,
    Hypothesis,
    Part,
    Standing,
    equation,
    invertible,
    nonnegative_by,
    nonzero,
    positive_by,
    vanishing,
)
from derivations.kernel import Claim, Mutation, prove
from derivations.notation import matrix, scalar, vector
from derivations.steps import Kind, Step

if TYPE_CHECKING:
    from collections.abc import Callable

A, B, K, U, X, Y = map(scalar, "abkuxy")
PROVED = Verdict(ruling=Ruling.PROVED, words="trust me")
NOTATION, CASE = Standing.NOTATION, Standing.CASE
FALSE: dict[str, tuple[Callable[[], Claim], str]] = {}  # statement -> claim, words of the refusal


def claim(*made: Any, hypotheses: Any = (), concludes: tuple[int, ...] = (1,)) -> Claim:
    """A claim by the steps given, or made when asked for, with a control that is in order."""

    def proof() -> Any:
        for step in made:
            yield step() if callable(step) else step

    def control() -> Any:
        yield algebra.identity("no", X, X + 1)

    def instance() -> Step:
        return algebra.refuting("$0 = 1$.", [0], [1])

    return Claim(
        name="false",
        title="False",
        statement="What is false.",
        concludes=concludes,
        source="[Mephisto]",
        proof=proof,
        controls={"another": Mutation(at=1, proof=control, instance=instance)},
        hypotheses=hypotheses,
        not_claimed="The truth.",
        not_in_coq="Nothing.",
    )


def false(statement: str, words: str) -> Callable[[Callable[[], Claim]], Callable[[], Claim]]:
    """Enter a claim of a false statement, with words of its refusal."""

    def enter(build: Callable[[], Claim]) -> Callable[[], Claim]:
        assert statement not in FALSE, statement
        FALSE[statement] = build, words
        return build

    return enter


def refusal(build: Callable[[], Claim]) -> str:
    """Why a claim is not proved; empty if it is."""
    try:
        verdict = prove(build()).verdict
    except (TypeError, ValueError) as error:
        return str(error)
    return "" if verdict.proved else verdict.words


def an_identity() -> Step:
    return algebra.identity("beside the point", (X + Y) ** 2, X**2 + 2 * X * Y + Y**2)


# The thirteen that were known, and three that always were refused ---------------------------------


@false("-1 >= 0, the square of i", "not a polynomial")
def _minus_one() -> Claim:
    return claim(lambda: algebra.nonnegative("-1", -1, [[Square(sympy.I)]]))


@false("every real x >= 0, the square of its root", "not a polynomial")
def _root() -> Claim:
    return claim(lambda: algebra.nonnegative("x", X, [[Square(sympy.sqrt(X))]]))


@false("the square of any complex z is nonnegative", "is not a real symbol")
def _complex() -> Claim:
    z = sympy.Symbol("z")
    return claim(lambda: algebra.nonnegative("z^2", z**2, [[Square(z)]]))


@false("the square of an imaginary z is nonnegative", "is not a real symbol")
def _imaginary() -> Claim:
    z = sympy.Symbol("z", imaginary=True)
    return claim(lambda: algebra.nonnegative("z^2", z**2, [[Square(z)]]))


@false("1 = 0, as x = 0 and x y = 1", "no point at which")
def _contradiction() -> Claim:
    zero, inverse = vanishing("$x = 0$.", X), vanishing("$x y = 1$.", X * Y - 1, solves=(Y,))
    step = algebra.combination("$1 = 0$.", 1, [(Y, zero[0]), (-1, inverse[0])])
    return claim(step, hypotheses=(zero, inverse))


@pytest.fixture(autouse=True)
def quickly(monkeypatch):
    """What is not found among a few points is not there, in these examples."""
    monkeypatch.setattr(instances, "TRIES", 30)


class Liar:
    """Equal to everything."""

    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        return True

    def __ne__(self, other: object) -> bool:
        return False


class NearlyOne(float, enum.Enum):
    ONE = 0.1 + 0.2


class Seven(int):
    __hash__ = int.__hash__

    def __ne__(self, other: object) -> bool:
        return False


for _name, _found, _told in (
    ("0.1 + 0.2 in a tuple", ((0.1 + 0.2,),), ((0.1 + 0.2,),)),
    ("0.1 + 0.2 in a set", (frozenset({0.1 + 0.2}),), (frozenset({0.1 + 0.2}),)),
    ("a complex number", (1j,), (1j,)),
    ("a NumPy float", (np.float32(0.1),), (np.float32(0.1),)),
    ("an object equal to everything", (Liar(),), (7,)),
    ("a subclass of int equal to everything", (Seven(7),), (8,)),
    ("a list of a root in floats", ([sympy.Float(0.1)],), ([sympy.Float(0.1)],)),
    ("a float as an enum's value", (NearlyOne.ONE,), (NearlyOne.ONE,)),
):

    @false(f"a fact by {_name}", "proves nothing")
    def _fact(found: Any = _found, told: Any = _told) -> Claim:
        return claim(lambda: algebra.facts("so it is", found, told), an_identity, concludes=(2,))


@false("anything, by a step of one's own", "made by algebra alone")
def _own_step() -> Claim:
    return claim(lambda: Step(says="$1 = 0$.", kind=Kind.IDENTITY, verdict=PROVED))


@false("masses are positive, so a = b", "speaks of an inequality")
def _words() -> Claim:
    same = vanishing("The masses are positive.", A - B, solves=(A,))
    return claim(algebra.combination("$a = b$.", A - B, [(1, same[0])]), hypotheses=(same,))


@false("a = b by notation", "occurs in")
def _notation() -> Claim:
    first = vanishing("$a$ is a number.", A - B, solves=(A,), standing=NOTATION)
    second = vanishing("$b = 1$.", B + A - 2, solves=(B,), standing=NOTATION)
    step = algebra.combination("$a = 1$.", 2 * A - 2, [(1, first[0]), (1, second[0])])
    return claim(step, hypotheses=(first, second))


@false("every x is positive, by the case x > 0", "in a case only")
def _one_case() -> Claim:
    above = positive_by("$x > 0$.", X, standing=CASE)
    return claim(algebra.positive("Every $x$ is positive.", X, [[above[0]]]), hypotheses=(above,))


@false("anything, by an irrelevant fact and a quotation", "no formula of letters")
def _irrelevant() -> Claim:
    fact = algebra.facts("$1 = 1$.", [1], [1])
    word = algebra.quoted("All is well.", theorem="Leibniz's optimism", source="[Leibniz1710]")
    return claim(an_identity(), fact, word, concludes=(2, 3))


@false("no entry of a vector that is not zero is zero", "a vector or a matrix")
def _vector() -> Claim:
    nonzero = invertible("The vector $M$ is not zero.", sympy.Matrix([X, Y]))
    step = algebra.positive("$M_1^2 > 0$.", X**2, [[Square(nonzero[0])]])
    return claim(step, hypotheses=(nonzero,))


@false("x^-1 x = 1 also at zero", "no formula of letters")
def _quotient() -> Claim:
    return claim(lambda: algebra.identity("$x^{-1}x = 1$.", X**-1 * X, 1))


@false("a scalar is the first entry of a vector", "an entry of")
def _collision() -> Claim:
    return claim(lambda: algebra.identity("$s = c_1$.", scalar("c_1"), vector("c")[0]))


@false("pi is a rational number", "not a polynomial")
def _pi() -> Claim:
    return claim(lambda: algebra.identity("$\\pi x$", sympy.pi * X, sympy.pi * X))


@false("0 > 0, as x > 0 and -x > 0", "")
def _nothing_between() -> Claim:
    above, below = positive_by("$x > 0$.", X), positive_by("$-x > 0$.", -X)
    step = algebra.positive("$0 > 0$.", 0, [[above[0]], [below[0]]])
    return claim(step, hypotheses=(above, below))


@false("every x is zero, by a hypothesis not declared", "what the claim does not assume")
def _undeclared() -> Claim:
    return claim(algebra.combination("$x = 0$.", X, [(1, vanishing("$x = 0$.", X)[0])]))


# Twenty more and some, found by reading the kernel ------------------------------------------------


@false("every nonnegative y is zero", "no hypothesis says")
def _positive_lead() -> Claim:
    above = nonnegative_by(r"$y \ge 0$.", Y, lead=(Y, 1))
    return claim(algebra.modulo("$y = 0$.", Y, 0, [above]), hypotheses=(above,))


@false("every positive y vanishes", "vanish by")
def _two_forms() -> Claim:
    both = Hypothesis(
        says="$y > 0$.", form=Condition.POSITIVE, values=(Y,), generators=(Y,), solves=(Y,)
    )
    return claim(algebra.combination("$y = 0$.", Y, [(1, both[0])]), hypotheses=(both,))


@false("x vanishes where y does", "vanish by")
def _other_generator() -> Claim:
    given = Hypothesis(says="$y = 0$.", form=Condition.VANISHES, values=(Y,), generators=(X,))
    return claim(algebra.combination("$x = 0$.", X, [(1, given[0])]), hypotheses=(given,))


@false("a column has an inverse, so x u = 1", "square")
def _column() -> Claim:
    column, row = sympy.Matrix([X, Y]), sympy.Matrix([[U, K]])
    given = invertible("$M$ is invertible.", column, row)
    return claim(algebra.combination("$x u = 1$.", X * U - 1, [(1, given[0])]), hypotheses=(given,))


@false("every number that is not zero is 1 or -1", "its own letter")
def _own_inverse() -> Claim:
    given = invertible(r"$x \ne 0$.", X, X, prepare=lambda _: {X: 1})
    return claim(algebra.combination("$x^2 = 1$.", X**2 - 1, [(1, given[0])]), hypotheses=(given,))


@false("every number that is not zero is 1/2", "its own letter")
def _given_inverse() -> Claim:
    given = invertible(r"$x \ne 0$.", X, 2, prepare=lambda _: {X: Fraction(1, 2)})
    return claim(algebra.combination("$2x = 1$.", 2 * X - 1, [(1, given[0])]), hypotheses=(given,))


@false("every number that is not zero is positive", "its own letter")
def _square_inverse() -> Claim:
    given = invertible(r"$x \ne 0$.", X, U**2, prepare=lambda _: {X: 1, U: 1})
    # x = x^2 u^2 - x (x u^2 - 1), so that x is the square of x u
    step = algebra.combination("$x = (x u)^2$.", X**2 * U**2 - X, [(X, given[0])])
    return claim(step, hypotheses=(given,))


class Nil(Part):
    """A part of a hypothesis that lies about its value."""

    value = sympy.Integer(1)  # type: ignore[assignment]


@false("1 = 0, by a part that lies", "no hypothesis says")
def _lying_part() -> Claim:
    zero = vanishing("$x = 0$.", X)
    made = lambda: algebra.combination("$1 = 0$.", 1, [(1, Nil(zero, 0)), (1, zero[0])])  # noqa: E731
    return claim(made, hypotheses=(zero,))


class Both(Hypothesis):
    """A hypothesis that holds everywhere, or so it says."""

    def holds_at(self, point: Any) -> bool:
        return True

    values_hold = holds_at


@false("1 = 0, by a hypothesis that says it holds", "no subclass")
def _lying_hypothesis() -> Claim:
    given = Both(
        says="$1 = 0$.",
        form=Condition.VANISHES,
        values=(sympy.Integer(1),),
        generators=(sympy.Integer(1),),
    )
    return claim(algebra.combination("$x = 0$.", X, [(X, given[0])]), hypotheses=(given,))


@false("the root of p^2 is p for every real p", "is not a real symbol")
def _hidden_sign() -> Claim:
    p = sympy.Symbol("p", positive=True)
    return claim(lambda: algebra.identity(r"$\sqrt{p^2} = p$.", sympy.sqrt(p**2), p))


@false("(-1)^n n = n for every n", "is not a real symbol")
def _hidden_parity() -> Claim:
    n = sympy.Symbol("n", even=True)
    return claim(lambda: algebra.identity("$(-1)^n n = n$.", (-1) ** n * n, n))


@false("x = y by letters that print alike", "is not a real symbol")
def _dummies() -> Claim:
    x = sympy.Dummy("x", real=True)
    return claim(lambda: algebra.identity("$x$", x, x))


@false("anything, by an identity of nothing", "nothing is compared")
def _empty_identity() -> Claim:
    return claim(lambda: algebra.identity("$1 = 0$.", [], []))


@false("anything, by a combination of nothing", "no formula of letters")
def _empty_combination() -> Claim:
    return claim(lambda: algebra.combination("$1 = 0$.", 0, []))


@false("anything, by a sum of nothing", "no formula of letters")
def _empty_sum() -> Claim:
    return claim(lambda: algebra.nonnegative(r"$-1 \ge 0$.", 0, []))


@false("a row is a column: every 2x3 matrix is one of 3x2", "2x3 against 3x2")
def _shapes() -> Claim:
    wide, tall = sympy.Matrix(2, 3, [A, B, K, U, X, Y]), sympy.Matrix(3, 2, [A, B, K, U, X, Y])
    return claim(lambda: algebra.identity("$A = B$.", wide, tall))


@false("every 11x11 matrix has A_{1,11} = A_{11,1}", "at most 10")
def _two_digits() -> Claim:
    return claim(lambda: algebra.identity("$A$", matrix("A", 11)[0, 10], matrix("A", 11)[10, 0]))


@false("anything, by a step number that there is not", "counted from 1")
def _step_zero() -> Claim:
    return claim(an_identity(), concludes=(0,))


@false("every x is 0, as k^2 + 1 = 0 by notation", "is not solved for")
def _no_root() -> Claim:
    root = vanishing("$k$ is a number.", K**2 + 1, standing=NOTATION, prepare=lambda _: {K: 0})
    return claim(
        algebra.combination("$x = 0$.", X * (K**2 + 1), [(X, root[0])]), hypotheses=(root,)
    )


@false("every x >= 0, being k^2 by notation", "is not solved for")
def _root_of_anything() -> Claim:
    root = equation("$k$ is a root of $x$.", K, 2, X, standing=NOTATION, prepare=_rooted)
    square = algebra.combination("$x = k^2$.", X - K**2, [(-1, root[0])])
    return claim(square, hypotheses=(root,))


def _rooted(point: Any) -> Any:
    return {X: point[K] ** 2}


@false("x = y, both of them k by notation", "occurs in")
def _twice() -> Claim:
    first = equation("$k = x$.", K, 1, X, standing=NOTATION, prepare=lambda p: {K: p[X]})
    second = equation("$k = y$.", K, 1, Y, standing=NOTATION, prepare=lambda p: {Y: p[K]})
    step = algebra.combination("$x = y$.", X - Y, [(-1, first[0]), (1, second[0])])
    return claim(step, hypotheses=(first, second))


@false("every x >= 0, by a notation that orders", "is not solved for")
def _order_by_notation() -> Claim:
    given = nonnegative_by("$x$ is a number.", X, standing=NOTATION)
    return claim(algebra.nonnegative(r"$x \ge 0$.", X, [[given[0]]]), hypotheses=(given,))


@false("x = y, by a step that is copied with another verdict", "made by algebra alone")
def _replaced() -> Claim:
    return claim(lambda: dataclasses.replace(algebra.identity("x = y", X, Y), verdict=PROVED))


@false("x = y, by a step that is changed", "no step of algebra")
def _changed() -> Claim:
    step = algebra.identity("x = y", X, Y)
    object.__setattr__(step, "verdict", PROVED)
    return claim(step)


@false("x = y, by what looks like a step", "no step of algebra")
def _looks_like_one() -> Claim:
    @dataclasses.dataclass
    class Like:
        says = "x = y"
        kind = Kind.IDENTITY
        verdict = PROVED
        asserted = None
        holds = True

    return claim(Like())


@false("x = y, by a class of steps that all hold", "made by algebra alone")
def _subclass() -> Claim:
    class Holding(Step):
        holds = True  # type: ignore[assignment]

    return claim(lambda: Holding(says="x = y", kind=Kind.IDENTITY, verdict=PROVED))


@false("0 > 0 in a case that the assumptions exclude", "no point at which")
def _impossible_case() -> Claim:
    zero = vanishing("$x = 0$.", X)
    inverse = vanishing("Where $x y = 1$.", X * Y - 1, standing=CASE, solves=(Y,))
    step = algebra.combination("$1 = 0$.", 1, [(Y, zero[0]), (-1, inverse[0])])
    first = algebra.combination("$x y = 0$.", X * Y, [(Y, zero[0])])
    return claim(first, step, hypotheses=(zero, inverse), concludes=(1, 2))


@false("x = 1, under what holds nowhere", "no point at which")
def _nowhere() -> Claim:
    given = vanishing("$x = 1$.", X - 1, further=lambda _: False)
    return claim(algebra.combination("$x = 1$.", X - 1, [(1, given[0])]), hypotheses=(given,))


@false("the number of solutions is True", "found True")
def _truth_is_one() -> Claim:
    return claim(an_identity(), lambda: algebra.facts("$n = 1$.", [True], [1]))


@false("x = 0 by a hypothesis that changes", "a tuple")
def _changing() -> Claim:
    values: Any = [X - X]
    given = Hypothesis(says="$0 = 0$.", form=Condition.VANISHES, values=values, generators=values)
    values[0] = X
    return claim(algebra.combination("$x = 0$.", X, [(1, given[0])]), hypotheses=(given,))


class Any_(tuple):  # noqa: N801, SLOT001
    """Hypotheses among which every hypothesis is found."""

    def __contains__(self, other: object) -> bool:
        return True


@false("x = 0 by hypotheses among which is everything", "a tuple")
def _everything_assumed() -> Claim:
    step = algebra.combination("$x = 0$.", X, [(1, vanishing("$x = 0$.", X)[0])])
    return claim(step, hypotheses=Any_())


@false("what is undefined equals itself", "not a polynomial")
def _undefined() -> Claim:
    return claim(lambda: algebra.identity("$0/0 = 0/0$.", sympy.nan * X, sympy.nan * X))


@false("every x is 0, as a product of it is with a letter that is never named", "")
def _free_inverse() -> Claim:
    given = vanishing("$u x = 1$.", U * X - 1, standing=NOTATION, solves=(U,))
    return claim(algebra.combination("$u x = 1$.", U * X - 1, [(1, given[0])]), hypotheses=(given,))


def in_cases(branches: Any, **further: Any) -> Claim:
    """x^2 >= 0 and what is said to cover."""
    made = lambda: algebra.cases("These are all cases.", branches, **further)  # noqa: E731
    return claim(an_identity(), made, hypotheses=tuple(branches))


@false("every number is positive or zero", "they leave a case out")
def _no_negative() -> Claim:
    return in_cases([positive_by("$x > 0$.", X, standing=CASE), vanishing("$x = 0$.", X)])


@false("every number is above 1 or below 0", "they leave a case out")
def _gap() -> Claim:
    return in_cases([positive_by("$x > 1$.", X - 1), positive_by("$x < 0$.", -X)])


@false("every whole number is at least 1 or at most -1", "they leave a case out")
def _no_zero() -> Claim:
    branches = [nonnegative_by(r"$x \ge 1$.", X - 1), nonnegative_by(r"$x \le -1$.", -X - 1)]
    return in_cases(branches, whole=True)


@false("a vector (x, y) that is not zero has x not zero", "they leave a case out")
def _one_entry() -> Claim:
    return in_cases([invertible(r"$x \ne 0$.", X)], unless=[X, Y])


@false("a vector of two entries, cases in one hypothesis", "on one expression each")
def _two_values() -> Claim:
    return in_cases([positive_by("$x, y > 0$.", [X, Y]), nonnegative_by(r"$x \le 0$.", -X)])


@false("x^2 > 0 where (x, y) is not zero", "it may be zero")
def _other_entry() -> Claim:
    somewhere = nonzero(r"$(x, y) \ne 0$.", [X, Y])
    return claim(
        lambda: algebra.positive("$x^2 > 0$.", X**2, [[Square(somewhere[0])]]),
        hypotheses=(somewhere,),
    )


def test_a_vector_that_is_not_zero_has_a_positive_norm():
    somewhere = nonzero(r"$(x, y) \ne 0$.", [X, Y])
    squares = [[Square(entry)] for entry in somewhere.parts]

    assert not refusal(
        lambda: claim(algebra.positive("", X**2 + Y**2, squares), hypotheses=(somewhere,))
    )


def test_cases_that_cover_are_proved():
    above, zero = positive_by("$x > 0$.", X), vanishing("$x = 0$.", X)
    below, other = nonnegative_by(r"$x \le 0$.", -2 * X), invertible(r"$y \ne 0$.", Y)
    next_one = nonnegative_by(r"$x \le -1$.", -X - 1)

    assert algebra.cases("", [above, zero, positive_by("$x < 0$.", -3 * X)]).verdict.proved
    assert algebra.cases("", [above, below]).verdict.proved
    assert algebra.cases("", [zero, invertible(r"$x \ne 0$.", X)]).verdict.proved
    assert algebra.cases("", [other, invertible("", -X)], unless=[X, Y]).verdict.proved
    assert algebra.cases("", [nonnegative_by("", X), next_one], whole=True).verdict.proved
    assert not algebra.cases("", [nonnegative_by("", X), next_one]).verdict.proved


@pytest.mark.parametrize("statement", FALSE)
def test_a_false_statement_is_refused(statement):
    build, words = FALSE[statement]
    why = refusal(build)

    assert why, "it is PROVED"
    assert words in why


def test_there_are_the_thirteen_and_twenty_more():
    assert len(FALSE) >= 33


def test_a_true_statement_of_the_same_making_is_proved():
    assert not refusal(lambda: claim(an_identity()))
