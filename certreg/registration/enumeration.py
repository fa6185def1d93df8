"""All equilibria of a problem: by one method, or by all of them, held against each other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar, cast

from certreg._loading import late
from certreg.certificate.checking import check_own, require_accepted
from certreg.equilibrium.equilibrium_set import EquilibriumSet
from certreg.equilibrium.methods import FINDERS, Comparison, Search, compare, search
from certreg.errors import UndecidedError
from certreg.objective.by_structure import objective_of
from certreg.objective.structure import Structure
from certreg.registration.ambiguity import equilibria_at
from certreg.registration.covariance import pose_covariance
from certreg.registration.exit_codes import code_of_list
from certreg.registration.fit import Fit, fit_of
from certreg.registration.optimum import optimal_pose, pose_at
from certreg.registration.problem_arguments import require_method, require_problem
from certreg.registration.progress import counted
from certreg.results import Absent, Brief

if TYPE_CHECKING:
    from certreg.certificate import count, listing
    from certreg.certificate.count import CountBody
    from certreg.certificate.envelope import Certificate
    from certreg.certificate.listing import SpringsListBody
    from certreg.equilibrium import paths
    from certreg.equilibrium.critical_set import CriticalSet
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration import equilibria as listed
    from certreg.registration.progress import Progress

    Certified = Certificate[Any] | Absent
else:
    count = late("certreg.certificate.count")
    listed = late("certreg.registration.equilibria")
    listing = late("certreg.certificate.listing")
    paths = late("certreg.equilibrium.paths")


ALL = "all"  # methods


Listed_co = TypeVar("Listed_co", covariant=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Enumeration(Brief, Generic[Listed_co]):
    """All equilibria, and the searches for them.

    critical, equilibria: of the first search whose list is complete, else of the first that came to
    one.
    comparison: of those that are complete; None if there was one search, or none is complete.
    """

    objective: Any
    searches: tuple[Search, ...]
    equilibria: Listed_co
    comparison: Comparison | None
    critical: CriticalSet = field(repr=False)

    def kept(self) -> dict[str, Any]:
        """The fields of the equilibria, for the same beside their searches."""
        found: Any = self.equilibria
        return {one.name: getattr(found, one.name) for one in fields(found)}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ListedEquilibria(EquilibriumSet):
    """An equilibrium set with the searches for it."""

    enumeration: Enumeration[EquilibriumSet]

    __repr__ = EquilibriumSet.__repr__

    @property
    def exit_code(self) -> int:
        """What `equilibria` ends with: 0; 3 where several are optimal; 4 where more may be."""
        return code_of_list(unique=self.classification.unique if self.complete else None)


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
    enumeration = enumerated(problem, method, progress=progress)
    return cast("EquilibriumSet", LISTS[enumeration.objective.structure].shown(enumeration))


def enumerated(
    problem: RegistrationProblem, method: str | None = None, *, progress: Progress | None = None
) -> Enumeration[Any]:
    """All equilibria, with every search that was made; arguments and errors as `equilibria`."""
    finders = FINDERS[Structure.of(problem.cell)]
    method = method or next(iter(finders))
    require_method(method, (*finders, ALL), problem.cell)
    objective = objective_of(problem)
    names = tuple(finders) if method == ALL else (method,)
    done = counted(progress, len(names))
    searches = tuple(_searched(objective, name, done) for name in names)
    sets = [each.critical for each in searches if each.critical is not None]
    if not sets:
        raise UndecidedError(searches[0].reason or "", method=method)
    sets.sort(key=lambda each: not each.complete)
    compared = method == ALL and sets[0].complete
    return Enumeration(
        objective=objective,
        searches=searches,
        equilibria=LISTS[objective.structure].described(sets[0], objective, problem),
        comparison=compare(sets) if compared else None,
        critical=sets[0],
    )


def _described_lines(
    critical: CriticalSet, objective: Isotropic, problem: RegistrationProblem
) -> EquilibriumSet:
    return equilibria_at(critical, objective, problem, lambda: _fit(problem, objective))


def _fit(problem: RegistrationProblem, objective: Isotropic) -> Fit:
    """What the optimum is worth as a fit."""
    covariance = pose_covariance(problem, objective)
    return fit_of(problem, objective, optimal_pose(objective), covariance)


def _searched(objective: Isotropic | Springs, name: str, done: Callable[[str], None]) -> Search:
    made = search(objective, name)
    done(name)
    return made


def equilibrium_poses(enumeration: Enumeration[Any]) -> list[Pose | Similarity]:
    """The pose of each equilibrium, in the order of the list; of a continuum one of them.

    Raises OutOfRangeError where no double can hold a translation.
    """
    objective, found = enumeration.objective, enumeration.critical.components
    shown = LISTS[objective.structure].shown(enumeration).components
    return [pose_at(objective, part.quaternion) for part in found[: len(shown)]]


def certified_count(problem: RegistrationProblem) -> Certificate[CountBody] | None:
    """A certificate of at most four equilibria that the checker accepted; None: infinitely many.

    None means not proved, not disproved. Raises RefusedCertificateError where certreg contradicts
    itself.
    """
    return _accepted(count.count_certificate(problem), problem)


def certified_list(
    problem: RegistrationProblem, objective: Springs
) -> Certificate[SpringsListBody] | None:
    """A certificate of all equilibria that the checker accepted; None: not proved, not disproved.

    Raises RefusedCertificateError where certreg contradicts itself.
    """
    lines = paths.critical_lines(objective.floating_quartic()[0])
    return _accepted(listing.springs_list_certificate(problem, objective, lines), problem)


def _accepted(made: Any, problem: RegistrationProblem) -> Any:
    """What was made, if anything was, once the checker has accepted it."""
    if made is not None:
        require_accepted(check_own(made, problem))
    return made


def certified(problem: RegistrationProblem, enumeration: Enumeration[Any]) -> Certified:
    """A certificate of the equilibria that the checker accepted, or why there is none."""
    return LISTS[enumeration.objective.structure].certified(problem, enumeration)


def _count_of_lines(problem: RegistrationProblem, _: Enumeration[Any]) -> Certified:
    return certified_count(problem) or Absent("there are infinitely many")


def _list_of_springs(problem: RegistrationProblem, enumeration: Enumeration[Any]) -> Certified:
    why = "the list is not proved complete"
    if enumeration.equilibria.complete:
        why = "only a list of 40 critical lines, complex ones included, has a certificate"
    return certified_list(problem, enumeration.objective) or Absent(why)


def _shown_lines(enumeration: Enumeration[EquilibriumSet]) -> Any:
    """Eigenlines, each with its scale where that is free."""
    objective: Isotropic = enumeration.objective
    if objective.scaling is not None:
        return listed.scaled_equilibria(objective, enumeration.equilibria, enumeration)
    return ListedEquilibria(**enumeration.kept(), enumeration=enumeration)


@dataclass(frozen=True, slots=True, kw_only=True)
class Listing:
    """How the equilibria of a structure are listed.

    described: what a critical set says of a body. shown: the same with the searches.
    certified: a certificate of the `subject`, or why there is none.
    """

    described: Callable[[Any, Any, RegistrationProblem], Any]
    shown: Callable[[Enumeration[Any]], Any]
    certified: Callable[[RegistrationProblem, Enumeration[Any]], Certified]
    subject: str


LISTS: Mapping[Structure, Listing] = {
    Structure.LINEAR: Listing(
        described=_described_lines,
        shown=_shown_lines,
        certified=_count_of_lines,
        subject="count",
    ),
    Structure.QUARTIC: Listing(
        described=lambda lines, energy, of: listed.spring_equilibria(lines, energy, of),  # noqa: PLW0108 - loaded when called
        shown=lambda found: replace(found.equilibria, enumeration=found),
        certified=_list_of_springs,
        subject="list",
    ),
}
