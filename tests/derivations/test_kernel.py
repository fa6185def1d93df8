"""The kernel can say no: proofs that break, hypotheses that are not needed, controls that pass."""

from __future__ import annotations

import dataclasses
from fractions import Fraction

import pytest

from certreg.results import Ruling
from derivations import algebra, instances
from derivations.algebra import Square
from derivations.hypothesis import (
    Standing,
    invertible,
    nonnegative_by,
    positive_by,
    vanishing,
)
from derivations.instances import counterexample
from derivations.kernel import Claim, Mutation, prove
from derivations.notation import scalar
from derivations.steps import Kind, Proof

X, Y, Z = scalar("x"), scalar("y"), scalar("z")
FORMULA = "$x = y$. As the program has it: $x - y = 0$."
SAME = vanishing("$x = y$.", X - Y, solves=(X,))
LENGTH = nonnegative_by(r"$y \\ge 0$.", Y)
ABOVE = positive_by("$y > 0$.", Y)


@pytest.fixture(autouse=True)
def quickly(monkeypatch):
    """What is not found among a few points is not there, in these examples."""
    monkeypatch.setattr(instances, "TRIES", 30)


def squares(difference=X**2 - Y**2, sum_of_both=X + Y) -> Proof:
    """x^2 = y^2 where x = y."""
    yield algebra.combination("$x^2 = y^2$.", difference, [(sum_of_both, SAME[0])])


def wrong() -> Proof:
    """x = -y where x = y."""
    yield algebra.combination("$x + y = 0$.", X + Y, [(1, SAME[0])])


def claim(proof=squares, **changes) -> Claim:
    whole = Claim(
        name="squares",
        title="Squares",
        statement="$x^2 = y^2$.",
        concludes=(1,),
        source="[Euclid]",
        proof=proof,
        controls={"x = -y": Mutation(at=1, proof=wrong)},
        hypotheses=(SAME,),
        not_claimed="The converse.",
        not_in_coq="Nothing.",
    )
    return dataclasses.replace(whole, **changes)


def words(verdict) -> str:
    assert verdict.ruling is Ruling.INCONCLUSIVE, verdict.words
    return verdict.words


def test_a_claim_of_this_form_is_proved():
    found = prove(claim())

    assert found.verdict.ruling is Ruling.PROVED
    assert found.verdict.words == "1 step checked, 1 mutated statement refuted, 1 hypothesis needed"


def test_a_claim_without_a_control_is_no_claim():
    with pytest.raises(ValueError, match="no negative control"):
        claim(controls={})


def test_a_claim_that_names_none_of_its_steps_is_no_claim():
    with pytest.raises(ValueError, match="which steps are its statement"):
        claim(concludes=())
    assert "there is no step 2" in words(prove(claim(concludes=(1, 2))).verdict)


def test_a_proof_stops_at_the_first_step_that_fails():
    def steps():
        yield algebra.identity("fine", X, X)
        yield algebra.identity("wrong", X, Y)
        yield algebra.identity("never seen", X, X)

    found = prove(claim(steps))

    assert found.verdict.ruling is Ruling.REFUTED
    assert found.verdict.words.startswith("step 2:")
    assert len(found.steps) == 2


def test_quoting_alone_proves_nothing():
    def steps():
        yield algebra.quoted("All is well.", theorem="optimism", source="[Leibniz1710]")

    found = prove(claim(steps))

    assert found.verdict.ruling is Ruling.INCONCLUSIVE
    assert [step.kind for step in found.quoted] == [Kind.QUOTED]


def test_an_exception_in_a_proof_refutes_it_in_words():
    def steps():
        yield algebra.identity("fine", X, X)
        raise ArithmeticError("a remainder")

    found = prove(claim(steps))

    assert found.verdict.ruling is Ruling.REFUTED
    assert found.verdict.words == "step 2: the proof broke off, ArithmeticError: a remainder"


# Hypotheses ---------------------------------------------------------------------------------------


def test_a_proof_may_use_no_hypothesis_that_is_not_declared():
    assert "what the claim does not assume: $x = y$" in words(prove(claim(hypotheses=())).verdict)


def test_a_hypothesis_that_no_step_needs_is_refused():
    idle = positive_by("$z > 0$.", Z)

    assert "no step needs it" in words(prove(claim(hypotheses=(SAME, idle))).verdict)


def test_a_hypothesis_used_without_need_is_refused():
    def steps():
        yield algebra.combination("$x^2 = y^2$.", X**2 - Y**2, [(X + Y, SAME[0]), (0, idle[0])])

    idle = vanishing("$z = 0$.", Z)

    assert "no step needs it" in words(prove(claim(steps, hypotheses=(SAME, idle))).verdict)


def test_a_hypothesis_that_others_imply_is_refused():
    implied = vanishing("$x^2 = y^2$.", X**2 - Y**2, prepare=lambda point: {X: -point[Y]})

    def steps():
        yield from squares()
        yield algebra.combination("$x^4 = y^4$.", X**4 - Y**4, [(X**2 + Y**2, implied[0])])

    found = prove(claim(steps, hypotheses=(SAME, implied), concludes=(1, 2)))

    assert "no instance shows the statement false without it" in words(found.verdict)


@pytest.mark.parametrize(("given", "proved"), [(LENGTH, True), (ABOVE, False)])
def test_positive_is_not_declared_where_nonnegative_would_do(given, proved):
    def steps():
        yield algebra.nonnegative("$x^2 + y$", X**2 + Y, [[Square(X)], [given[0]]])

    def mutated():
        yield algebra.nonnegative("$x^2 - y$", X**2 - Y, [[Square(X)], [given[0]]])

    controls = {"minus": Mutation(at=1, proof=mutated)}
    found = prove(claim(steps, hypotheses=(given,), controls=controls))

    assert found.verdict.proved is proved
    if not proved:
        assert "would do with nonnegative" in words(found.verdict)


def test_without_positive_the_instance_lies_on_the_boundary():
    def steps():
        yield algebra.positive("$y$", Y, [[ABOVE[0]]])

    def mutated():
        yield algebra.positive("$y - 2$", Y - 2, [[ABOVE[0]]])

    controls = {"two less": Mutation(at=1, proof=mutated)}
    found = prove(claim(steps, hypotheses=(ABOVE,), controls=controls))

    assert found.verdict.proved
    assert found.dropped[0].words == "at zero: 0, not positive"


def test_an_inverse_is_missed_only_where_there_is_none():
    inverse = invertible("$y$ is invertible.", Y, Z)

    assert inverse.fails_at({Y: Fraction(0), Z: Fraction(7)})
    assert not inverse.fails_at({Y: Fraction(2), Z: Fraction(7)})
    assert not inverse.holds_at({Y: Fraction(2), Z: Fraction(7)})


def test_what_is_printed_as_assumed_are_the_hypotheses():
    case = vanishing("For the second part: $z = 0$.", Z, standing=Standing.CASE)
    found = claim(hypotheses=(SAME, case), setting=("Numbers are real.",))

    assert found.assumptions == (FORMULA,)
    assert claim(hypotheses=()).assumptions == ("None.",)
    assert dict(found.premises) == {
        "Assumptions": (FORMULA,),
        "Setting": ("Numbers are real.",),
        "Where a step says so": ("For the second part: $z = 0$.",),
    }
    assert claim(hypotheses=(), inherits=(found,)).assumptions == (FORMULA,)


def test_what_is_printed_of_many_values_is_their_number_and_the_shortest():
    long = nonnegative_by("All of them.", [X, *(X**k + Y**k * Z**k for k in range(2, 9))])

    assert positive_by("$y > 0$.", Y).formula == "$y > 0$"
    assert long.formula == r"8 expressions $\ge 0$, such as $x \ge 0$"


# Mutated statements -------------------------------------------------------------------------------


def refused(**mutation) -> str:
    verdict = prove(claim(controls={"mutated": Mutation(**mutation)})).verdict
    return words(verdict).removeprefix("the mutated statement 'mutated': ")


def test_a_control_that_passes_spoils_the_claim():
    assert refused(at=1, proof=squares) == "the proof also proves this"


def test_a_control_that_fails_at_another_step_spoils_the_claim():
    assert refused(at=2, proof=wrong) == "it fails at step 1, not at step 2"


def test_a_control_that_breaks_off_is_no_refutation():
    assert "the proof broke off, KeyError" in refused(at=1, proof=lambda: {}["proof"])


def test_a_control_without_steps_is_no_refutation():
    assert "no step" in refused(at=1, proof=lambda: ())


def test_a_mutated_proof_of_a_true_statement_is_no_control():
    """The step fails, for its cofactor is wrong; what it says is true all the same."""
    assert refused(at=1, proof=lambda: squares(sum_of_both=X - Y)) == "no instance shows it false"


def test_a_control_that_fails_in_a_lemma_needs_an_instance_of_its_own():
    def steps(second=X):
        yield algebra.identity("a lemma", X, second)
        yield from squares()

    false = algebra.refuting("At $x = 1$, $y = -1$.", [1], [-1])
    true = algebra.refuting("At $x = y = 1$.", [1], [1])
    mutated = Mutation(at=1, proof=lambda: steps(Y))

    def ruling(control):
        return prove(claim(steps, concludes=(2,), controls={"mutated": control})).verdict

    assert "there is no instance" in words(ruling(mutated))
    assert "its instance is none" in words(
        ruling(dataclasses.replace(mutated, instance=lambda: true))
    )
    assert ruling(dataclasses.replace(mutated, instance=lambda: false)).proved


def test_an_instance_obeys_every_hypothesis_and_is_exact():
    step = next(iter(wrong()))
    assert step.asserted is not None
    found = counterexample(step.asserted, (SAME,), first={})
    outside = counterexample(step.asserted, (SAME,), SAME, first={X: 1})

    assert found is not None
    assert outside is not None
    point = dict(found.point)
    assert point[X] == point[Y] != 0
    assert found.value == 2 * point[X]
    assert dict(outside.point) == {X: 1, Y: 0}
    assert outside.words == "at x = 1, all else 0: 1, not 0"


def test_an_instance_obeys_what_a_hypothesis_says_beyond_its_values():
    step = next(iter(wrong()))
    assert step.asserted is not None
    nowhere = nonnegative_by("$y > 9$.", Y, further=lambda point: point[Y] > 9)

    assert counterexample(step.asserted, (SAME, nowhere), first={}) is None
    assert counterexample(step.asserted, (SAME, nowhere), first={Y: 10}) is not None
