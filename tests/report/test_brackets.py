"""Printed bounds bracket an exact oracle: a sample of `make rates NAME=brackets`."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

import flint
import numpy as np
import pytest
from commands import checked
from oracles import kabsch
from oracles.kabsch import Oracle
from strategies import ZOO, random_problem

from benchmarks.rates import brackets
from benchmarks.rates.brackets import BITS, FAMILIES, bounds_of, made
from certreg.certificate.bounds import ExactPose, PoseBounds, pose_bounds
from certreg.exact.dyadic import Dyadic
from certreg.registration.certification import certify
from certreg.report.document import result_document
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.summary import registration_summary
from certreg.verify import Worth, parse

if TYPE_CHECKING:
    from certreg.registration.result import Registration


EVERYWHERE = {  # where bounds are printed; a page or a sentence that is written anew is read anew
    "JSON angle_bound_rad",
    "JSON gap_bound",
    "JSON gap_share",
    "JSON proved_gap",
    "assess gap_lower",
    "assess gap_upper",
    "certificate gap",
    "certificate sdp_gap",
    "certificate sin#",
    "checker: Every global optimum is within # degrees of R",
    "checker: The relaxation's dual bounds that gap by #.",
    "checker: This gap is less than # of the range",
    "checker: exceeds the global minimum by less than #",
    "checker: the minimum is at least #; sqrt(gap / sum of weights) is below #.",
    "checker: weights: #; objective at R, best translation: #; both",
    "dual: bounds the gap of the certified rotation independently: at most #.",
    "dual: which alone proves a gap of at most #",
    "page: above the global minimum: # of the range",
    "page: exceeds the minimum by at most #.",
    "page: given below is within # degrees of it",
    "page: ≤ # of the objective above the global minimum",
    "terminal: objective - minimum <= #",
    "terminal: objective - minimum <= #, # of the range",
    "terminal: within # degrees of the optimum",
}


@pytest.fixture(scope="module")
def registration() -> Registration:
    return certify(random_problem(np.random.default_rng(16), n=6), simulation=False)


# The sample --------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("seed", range(3 * len(FAMILIES)))
def test_every_printed_bound_is_one(seed: int):
    bounds = bounds_of(made(seed), seed)

    assert not [bound.place for bound in bounds if not bound.holds()]
    assert len(bounds) > 15


@pytest.mark.slow
def test_every_place_where_a_bound_is_printed_is_read(registration: Registration):
    kinds = {bound.kind for bound in bounds_of(registration.problem)}

    assert kinds >= EVERYWHERE


@pytest.mark.slow
def test_a_bound_that_is_none_is_seen():
    bounds = [bound for bound in bounds_of(made(0)) if bound.printed]
    for bound in bounds:
        with flint.ctx.workprec(BITS):
            near = Fraction(float(bound.true.mid().str(20, radius=False)))
        worse = near * (1 + Fraction(1, 10**9) * (1 if bound.lower else -1))
        assert bound.holds()
        assert not replace(bound, printed=worse).holds(), bound.place


# The oracle --------------------------------------------------------------------------------------


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_the_oracle_knows_the_zoo(specimen):
    """`pattern` is proved by hand: the first entry is 1 iff the optimum is unique."""
    with flint.ctx.workprec(BITS):
        oracle = Oracle.of(specimen.problem)
        assert oracle.unique == (specimen.pattern[0] == 1)
        if oracle.unique:
            pairs = zip(oracle.optimum, oracle.C, strict=True)
            terms = [a * kabsch.ball(b) for r, s in pairs for a, b in zip(r, s, strict=True)]
            assert sum(terms, flint.arb(0)).overlaps(oracle.best)
            gram = kabsch.product(kabsch.transpose(oracle.optimum), oracle.optimum)
            assert all(gram[i][j].overlaps(flint.arb(i == j)) for i in range(3) for j in range(3))
            assert kabsch.det(oracle.optimum).overlaps(flint.arb(1))


# Each kind of rounding by itself -----------------------------------------------------------------

ABOVE = Fraction(2**60 + 1, 2**60)  # the nearest double is 1: too little for an upper bound
BELOW = Fraction(2**60 - 1, 2**60)  # and too much for a lower one


def claiming(registration: Registration, **claims: Any) -> Registration:
    """As if the certificate claimed something else."""
    solution = registration.solution
    certificate = checked(solution.certificate)
    body = replace(certificate.body, claims=replace(certificate.body.claims, **claims))
    stated = replace(solution, certificate=replace(certificate, body=body))
    return replace(registration, solution=stated)


def test_the_gap_of_the_relaxation_is_rounded_up(registration: Registration):
    odd = claiming(registration, sdp_gap=Dyadic(mantissa=2**60 + 1, exponent=-60))
    document = result_document(odd)

    assert document["relaxation"]["proved_gap"] == math.nextafter(1.0, 2.0)
    assert ", which alone proves a gap of at most 1.01\n" in registration_summary(odd)
    page = brackets.seen(html_page(Report.of(odd)))
    assert "of the certified rotation independently: at most 1.01." in page


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize(("gap", "nothing"), [(1 - 2**-50, False), (1, True), (2, True)])
def test_a_gap_of_the_relaxation_that_reaches_over_the_range_bounds_nothing(
    registration: Registration, gap: float, *, nothing: bool
):
    bounds = replace(checked(registration.bounds), least_range_squared=Fraction(1))
    mantissa, exponent = Fraction(gap).as_integer_ratio()
    odd = claiming(
        replace(registration, bounds=bounds),
        sdp_gap=Dyadic(mantissa=mantissa, exponent=1 - exponent.bit_length()),
    )

    assert (", which bounds nothing\n" in registration_summary(odd)) == nothing
    page = brackets.seen(html_page(Report.of(odd)))
    assert (" It bounds nothing: the range of energies may be smaller." in page) == nothing


def test_where_the_range_is_zero_no_gap_is_called_vague(registration: Registration):
    flat = replace(checked(registration.bounds), least_range_squared=Fraction(0))

    assert not flat.covers_range(Fraction(0))
    assert not flat.covers_range(Fraction(1))


def test_gap_and_share_of_a_pose_are_rounded_outwards(registration: Registration):
    bounds = PoseBounds(
        least_gap=BELOW, greatest_gap=ABOVE, angle_upper=0.5, least_range_squared=Fraction(1)
    )
    odd = replace(registration, bounds=bounds)
    stated = result_document(odd)["optimality"]

    assert stated["gap_bound"] == math.nextafter(1.0, 2.0)
    assert Fraction(stated["gap_share"]) >= ABOVE
    assert "objective - minimum <= 1.01, 1.01 times the range" in registration_summary(odd)
    assert bounds.gap_lower == math.nextafter(1.0, 0.0)
    assert " within 28.7 degrees of" in registration_summary(odd)  # 0.5 rad is 28.64... degrees


@pytest.mark.parametrize(("claimed", "turned"), [(0.3, 0.2), (1e-9, 0.2), (0.2, 1e-9), (3.0, 1.0)])
def test_the_angle_of_a_pose_is_bounded_by_the_sum_of_two(
    registration: Registration, claimed: float, turned: float
):
    """The optimum may lie on the other side of the certified rotation: no less would do."""
    body = checked(registration.solution.certificate).body
    sine = Dyadic(mantissa=round(math.sin(claimed / 2) ** 2 * 2.0**80), exponent=-80)
    body = replace(body, claims=replace(body.claims, sin2_half_angle=sine))
    q = np.array(body.quaternion, dtype=float)
    w, x, y, z = q / np.linalg.norm(q)
    across = np.array([-x, w, z, -y])  # a turn about the first axis
    pose = math.cos(turned / 2) * np.array([w, x, y, z]) + math.sin(turned / 2) * across
    place = ExactPose.of_doubles(pose, np.zeros(3))
    upper = checked(pose_bounds(registration.solution.objective, body, place).angle_upper)

    assert min(math.pi, claimed + turned) - 1e-12 <= upper
    assert upper <= min(math.pi, (claimed + turned) * (1 + 1e-9))


def test_a_certificate_of_another_rotation_bounds_the_gap_of_every_pose(registration: Registration):
    """What a weak certificate leaves open of its own rotation is open of each pose."""
    certificate, objective = checked(registration.solution.certificate), registration.solution
    off = tuple(round(entry * 2**20) for entry in np.array([1.0, 0.05, -0.02, 0.1]))
    with flint.ctx.workprec(BITS):
        oracle = Oracle.of(registration.problem)
        true = oracle.gap([Fraction(entry) for entry in off])
        claimed = Dyadic(mantissa=math.ceil(float(true.mid()) * 2**20) + 1, exponent=-20)
    body = replace(certificate.body, quaternion=off)
    body = replace(body, claims=replace(body.claims, gap=claimed))
    for q in (off, certificate.body.quaternion, (3, 1, -1, 2)):
        exact = [Fraction(entry) for entry in q]
        x, y = oracle.mean(oracle.source), oracle.mean(oracle.target)
        R = kabsch.rotation(exact)
        t = [
            b - sum(a * c for a, c in zip(row, x, strict=True)) for row, b in zip(R, y, strict=True)
        ]
        place = ExactPose(quaternion=q, translation=tuple(t))
        bounds = pose_bounds(objective.objective, body, place)
        with flint.ctx.workprec(BITS):
            assert kabsch.ball(bounds.greatest_gap) >= oracle.gap(exact, t)
            assert not bounds.least_gap or kabsch.ball(bounds.least_gap) <= oracle.gap(exact, t)


@pytest.mark.parametrize("degrees", ["1.2e-5", "7.0e-15", "90"])
def test_the_checkers_degrees_are_no_fewer_than_its_radians(registration: Registration, degrees):
    """180/pi is rounded up there: a little more than such an angle is told as the next number."""
    content = checked(registration.solution.certificate).to_json()
    statement: Any = parse(content)
    with flint.ctx.workprec(BITS):
        least = Fraction(degrees) * (1 + Fraction(1, 10**9))
        radians = kabsch.ball(least) * flint.arb.pi() / 180
        angle = Fraction(Decimal(radians.str(40, radius=False)))
    weigh = partial(replace, WORTH, angle=angle)
    words = list(statement._words(weigh, [1, 1, 1, 1], solid=True, equal=True))
    (told,) = [line for line in words if line.startswith("Every global optimum is within ")]

    assert Fraction(Decimal(told.split()[5])) >= least


WORTH = Worth(
    weight=Fraction(1),
    objective=Fraction(1),
    minimum=Fraction(1),
    gap=Fraction(1, 2**99),
    length=Fraction(1, 2**49),
    share=Fraction(1, 2**99),
    angle=None,
)
