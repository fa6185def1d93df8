"""All equilibria of a problem: by one method, or by all of them, held against each other."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, cast

from certreg._loading import late
from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.producing import count_certificate
from certreg.equilibrium.methods import METHODS, compare, search
from certreg.equilibrium.presentation import EquilibriumSet
from certreg.errors import UndecidedError
from certreg.objective.isotropic import Isotropic
from certreg.registration.ambiguity import equilibria_at
from certreg.registration.covariance import pose_covariance
from certreg.registration.fit import fit_of
from certreg.registration.optimum import optimal_pose, pose_at
from certreg.registration.parts import counted
from certreg.registration.stating import require_method, require_problem
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.certificate.count import CountBody
    from certreg.certificate.envelope import Certificate
    from certreg.equilibrium.methods import Comparison, Search
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration import breathing, spring_enumeration
    from certreg.registration.fit import Fit
    from certreg.registration.parts import Progress
    from certreg.registration.spring_enumeration import SpringEnumeration
else:  # of a free scale, and of general springs
    breathing = late("certreg.registration.breathing")
    spring_enumeration = late("certreg.registration.spring_enumeration")

ALL = "all"  # methods


@dataclass(frozen=True, slots=True, kw_only=True)
class Enumeration(Brief):
    """All equilibria, and the searches for them.

    equilibria: at the end of the first search. comparison: of several; None if there was one.
    """

    objective: Isotropic
    searches: tuple[Search, ...]
    equilibria: EquilibriumSet
    comparison: Comparison | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ListedEquilibria(EquilibriumSet):
    """An equilibrium set with the searches for it."""

    enumeration: Enumeration

    def __repr__(self) -> str:
        return EquilibriumSet.__repr__(self)

    @classmethod
    def of(cls, enumeration: Enumeration) -> ListedEquilibria:
        """The set that an enumeration found."""
        found = enumeration.equilibria
        kept: dict[str, Any] = {one.name: getattr(found, one.name) for one in fields(found)}
        return cls(**kept, enumeration=enumeration)


def equilibria(
    problem: RegistrationProblem,
    method: str | None = None,
    *,
    progress: Progress | None = None,
) -> EquilibriumSet:
    """All equilibria of the registration dynamics of a problem.

    Of general springs they come as `SpringEquilibria`: up to forty, stable ones beside the optimum
    among them, or a list that says what it leaves open. Of a free scale they come as
    `ScaledEquilibria`, each with its scale.

    Parameters
    ----------
    problem
        Points, weights or springs, and damping.
    method
        "spectral", the eigenspaces of the Davenport matrix; "groebner", exact elimination of the
        torque quadratics; "homotopy", continuation in floating point, each root proved in ball
        arithmetic; "all", every one of them, held against each other. None: "spectral", and
        "homotopy" of general springs, which have no eigenspaces.
    progress
        Called with the number of searches that are done and that of all.

    Returns
    -------
    EquilibriumSet
        With energies, indices and stability.

    Raises
    ------
    InvalidProblemError
        For what is no problem, as two clouds: they make one, `RegistrationProblem(source, target)`.
        For other methods; with a free scale for all but "spectral".
    UndecidedError
        Where the homotopy comes to no list.
    ContradictionError
        Where two methods disagree.
    """
    require_problem(problem, "equilibria")
    if problem.factors is not None:
        found = spring_enumeration.enumerated_springs(problem, method, progress=progress)
        listed = spring_enumeration.ListedSpringEquilibria.of(found)
        return cast("EquilibriumSet", listed)
    enumeration = enumerated(problem, method, progress=progress)
    if problem.scaled:
        scaled = breathing.scaled_equilibria(enumeration.objective, enumeration.equilibria)
        return cast("EquilibriumSet", scaled)
    return ListedEquilibria.of(enumeration)


def enumerated(
    problem: RegistrationProblem, method: str | None = None, *, progress: Progress | None = None
) -> Enumeration:
    """All equilibria, with every search that was made; arguments and errors as `equilibria`."""
    first, *_ = METHODS
    method = method or first
    require_method(method, (*METHODS, ALL), problem.cell)
    objective = Isotropic.of(problem)
    names = tuple(METHODS) if method == ALL else (method,)
    done = counted(progress, len(names))
    searches = tuple(_searched(objective, name, done) for name in names)
    sets = [each.critical for each in searches if each.critical is not None]
    if not sets:
        (reason,) = (each.reason for each in searches)
        raise UndecidedError(reason or "", method=method)
    return Enumeration(
        objective=objective,
        searches=searches,
        equilibria=equilibria_at(sets[0], objective, problem, lambda: _fit(problem, objective)),
        comparison=compare(sets) if method == ALL else None,
    )


def _fit(problem: RegistrationProblem, objective: Isotropic) -> Fit:
    """What the optimum is worth as a fit."""
    covariance = pose_covariance(problem, objective)
    return fit_of(problem, objective, optimal_pose(objective), covariance)


def _searched(objective: Isotropic, name: str, done: Callable[[str], None]) -> Search:
    made = search(objective, name)
    done(name)
    return made


def equilibrium_poses(enumeration: Enumeration | SpringEnumeration) -> list[Pose | Similarity]:
    """The pose of each equilibrium, in the order of the list; of a continuum one of them.

    Raises OutOfRangeError where no double can hold a translation.
    """
    if not isinstance(enumeration, Enumeration):
        return [part.pose for part in enumeration.equilibria.components]
    critical = next(each.critical for each in enumeration.searches if each.critical is not None)
    objective, kept = enumeration.objective, len(critical.components)
    if objective.scaling is not None:
        kept = len(breathing.scaled_equilibria(objective, enumeration.equilibria).components)
    return [pose_at(objective, part.quaternion) for part in critical.components[:kept]]


def certified_count(problem: RegistrationProblem) -> Certificate[CountBody] | None:
    """A certificate of at most four equilibria that the checker accepted; None: infinitely many.

    None means not proved, not disproved. Raises RefusedCertificateError where certreg contradicts
    itself.
    """
    certificate = count_certificate(problem)
    if certificate is not None:
        require_accepted(check_own(certificate, problem))
    return certificate
