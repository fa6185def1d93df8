"""All equilibria of a problem: by one road, or by all of them, held against each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.certificate import check_own, count_certificate, require_accepted
from certreg.equilibrium import equilibrium_set
from certreg.problem import exact_moments

if TYPE_CHECKING:
    from certreg.certificate import Certificate, CountBody
    from certreg.equilibrium import EquilibriumSet, Road, RoadAgreement
    from certreg.problem import RegistrationProblem

ALL = "all"  # roads


def equilibria(problem: RegistrationProblem, method: str = "spectral") -> EquilibriumSet:
    """All equilibria of the registration dynamics of a problem.

    method: "spectral", the eigenspaces of the Davenport matrix; "groebner", exact elimination of
        the torque quadratics; "homotopy", continuation in floating point, each root proved in ball
        arithmetic; "all", every one of them, held against each other. Raises ValueError for others.
    Raises UndecidedError where the homotopy comes to no list, and ContradictionError where two
    roads disagree.
    """
    if method == ALL:
        return road_equilibria(problem, equilibrium_roads(problem).roads[0])
    return road_equilibria(problem, equilibrium_road(problem, method))


def equilibrium_road(problem: RegistrationProblem, method: str) -> Road:
    """One road to the equilibria, by name. Raises ValueError and UndecidedError: `equilibria`."""
    from certreg.equilibrium import Method, road

    if method not in {known.value for known in Method}:
        known = ", ".join(repr(each.value) for each in Method)
        message = f"method is {method!r}: this version knows {known} and {ALL!r}"
        raise ValueError(message)
    return road(exact_moments(problem), Method(method))


def equilibrium_roads(problem: RegistrationProblem) -> RoadAgreement:
    """Every road to the equilibria. Raises ContradictionError where two disagree."""
    from certreg.equilibrium import all_roads

    return all_roads(exact_moments(problem))


def certified_count(problem: RegistrationProblem) -> Certificate[CountBody] | None:
    """A certificate of at most four equilibria that the checker accepted; None: infinitely many.

    None means not proved, not disproved. Raises RefusedCertificateError where certreg contradicts
    itself.
    """
    certificate = count_certificate(problem)
    if certificate is not None:
        require_accepted(check_own(certificate, problem))
    return certificate


def road_equilibria(problem: RegistrationProblem, taken: Road) -> EquilibriumSet:
    """The equilibrium set at the end of a road."""
    return equilibrium_set(
        taken.found, problem.damping, guarantee=taken.guarantee, doubt=taken.doubt
    )
