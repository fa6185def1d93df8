"""The dynamics of a free scale in words: what is listed, moved, left out and refused."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import certreg
from certreg import RegistrationProblem
from certreg.errors import InvalidProblemError
from certreg.registration.simulation import optimally_damped

if TYPE_CHECKING:
    from collections.abc import Sequence

pytestmark = pytest.mark.quick
SOURCE = np.array([s * row for row in np.eye(3) for s in (1.0, -1.0)])
THREE, TWO, FLAT, SMALL = (4.0, 3.0, -2.0), (3.0, 2.0, 0.5), (3.0, 0.0, 0.0), (0.4, 0.4, 0.4)
LAST = "stable; only through the scale 0, where the motion is not defined, does a body come there."


def problem(factors: Sequence[float], scale: str = "asymmetric") -> RegistrationProblem:
    """Six points on the axes; the target is stretched along each by one of the factors."""
    return RegistrationProblem(SOURCE, SOURCE * factors, scale=scale)


@pytest.mark.parametrize(
    ("factors", "count", "inside_out"),
    [
        (THREE, "exactly three with a scale above 0: the optimum and two spurious", "one more"),
        (TWO, "exactly two with a scale above 0: the optimum and one spurious", "two more"),
        (SMALL, "exactly one with a scale above 0: the optimum alone", "one projective plane"),
        (FLAT, "one circle with a scale above 0", "one circle"),
    ],
)
def test_how_many_equilibria_there_are_above_and_below_the_scale_0(
    factors: tuple[float, ...], count: str, inside_out: str
):
    first, *_, below, _ = str(certreg.equilibria(problem(factors))).splitlines()

    assert first == f"Equilibria (exact, complete): {count}."
    assert below == f"Inside out (scale below 0): {inside_out}, one {LAST}"


def test_without_a_correlation_there_is_none_at_all():
    assert str(certreg.equilibria(problem((0.0, 0.0, 0.0)))).splitlines()[:2] == [
        "Equilibria (exact, complete): none with a scale above 0; the body shrinks to a point.",
        "Inside out (scale below 0): none.",
    ]


def test_a_motion_tells_its_scales_its_rates_and_that_it_never_collapses():
    moved = str(certreg.simulate(problem(THREE)))

    assert "1.66665 at the end, from 1; that of the optimum is 1.66667" in moved
    assert "(norm of the 20 rates of change)" in moved
    assert moved.endswith(
        "Proved: the exact motion never comes to the scale 0: the body begins with less energy "
        "than a source shrunk to a point has."
    )


def test_a_body_released_with_more_energy_than_a_point_has_may_collapse():
    assert str(certreg.simulate(problem(SMALL))).endswith(
        "Not proved that the exact motion never comes to the scale 0: the body begins with at "
        "least the energy that a source shrunk to a point has."
    )


def test_documents_give_the_reason_of_what_is_null():
    run: Any = certreg.simulate(problem(TWO))
    moved = run.to_dict()
    certified: Any = certreg.certify(problem(TWO), relaxation=False).to_dict()
    symmetric: Any = certreg.certify(problem(TWO, "symmetric"), relaxation=False).to_dict()

    assert moved["basin"]["words"] == "no basin is certified of a body whose scale is free"
    assert moved["reasons"]["decay_rate"] == moved["basin"]["words"]
    assert certified["reasons"]["equilibria.components[0].eigenvalues"] == (
        "the motion with a free scale has more modes, which are not listed here"
    )
    assert symmetric["equilibria"]["inside_out"] is None
    assert symmetric["reasons"]["equilibria.inside_out"] == "the symmetric scale is never below 0"


def test_what_minimises_over_the_scale_has_no_motion():
    words = (
        "the symmetric scale minimises the energy over the scale, which no springs have: leave out "
        "--scale (scale=), or take the asymmetric one"
    )
    with pytest.raises(InvalidProblemError, match=f"^{re.escape(words)}$"):
        certreg.simulate(problem(TWO, "symmetric"))


def test_other_methods_than_eigenspaces_know_no_scale():
    words = "with a free scale the equilibria are counted by eigenspaces alone: take 'spectral'"
    with pytest.raises(InvalidProblemError, match=f"^{words}$"):
        certreg.equilibria(problem(TWO), "groebner")


def test_an_optimal_damping_is_of_rigid_motions():
    words = (
        "an optimal damping is computed for one weight per pair and scale 1 alone: give a number, "
        "or leave it out"
    )
    with pytest.raises(InvalidProblemError, match=f"^{words}$"):
        optimally_damped(problem(TWO))
