"""All equilibria of general springs: by one method, or by all of them, held against each other."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, cast

from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.producing_springs import springs_list_certificate
from certreg.equilibrium.methods import SPRING_METHODS, compare, search
from certreg.equilibrium.paths import critical_lines
from certreg.errors import UndecidedError
from certreg.objective.springs import Springs
from certreg.problem.stiffness import spring_moments
from certreg.registration.parts import counted
from certreg.registration.spring_equilibria import SpringEquilibria, spring_equilibria
from certreg.registration.stating import require_method
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.certificate.envelope import Certificate
    from certreg.certificate.springs_list import SpringsListBody
    from certreg.equilibrium.line_set import LineSet
    from certreg.equilibrium.methods import Comparison, Search
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.parts import Progress

ALL = "all"  # methods


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringEnumeration(Brief):
    """The equilibria of general springs, and the searches for them.

    equilibria: of the first search whose list is complete, else of the first. comparison: of those
    that are complete; None if there was one search, or none is complete.
    """

    objective: Springs
    searches: tuple[Search, ...]
    equilibria: SpringEquilibria
    comparison: Comparison | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ListedSpringEquilibria(SpringEquilibria):
    """The equilibria of general springs with the searches for them."""

    enumeration: SpringEnumeration

    def __repr__(self) -> str:
        return SpringEquilibria.__repr__(self)

    @classmethod
    def of(cls, enumeration: SpringEnumeration) -> ListedSpringEquilibria:
        """The set that an enumeration found."""
        found = enumeration.equilibria
        kept: dict[str, Any] = {one.name: getattr(found, one.name) for one in fields(found)}
        return cls(**kept, enumeration=enumeration)


def enumerated_springs(
    problem: RegistrationProblem, method: str | None = None, *, progress: Progress | None = None
) -> SpringEnumeration:
    """All equilibria of general springs, every search; arguments and errors as `equilibria`."""
    first, *_ = SPRING_METHODS
    method = method or first
    require_method(method, (*SPRING_METHODS, ALL), problem.cell)
    objective = Springs(spring_moments(problem))
    names = tuple(SPRING_METHODS) if method == ALL else (method,)
    done = counted(progress, len(names))
    searches = tuple(_searched(objective, name, done) for name in names)
    sets = [cast("LineSet", each.critical) for each in searches if each.critical is not None]
    if not sets:
        reasons = [each.reason for each in searches]
        raise UndecidedError(reasons[0] or "", method=method)
    sets.sort(key=lambda each: not each.complete)
    compared = method == ALL and sets[0].complete
    return SpringEnumeration(
        objective=objective,
        searches=searches,
        equilibria=spring_equilibria(sets[0], objective, problem),
        comparison=compare(sets) if compared else None,
    )


def certified_list(
    problem: RegistrationProblem, objective: Springs
) -> Certificate[SpringsListBody] | None:
    """A certificate of all equilibria that the checker accepted; None: not proved, not disproved.

    Raises RefusedCertificateError where certreg contradicts itself.
    """
    lines = critical_lines(objective.floating_quartic()[0])
    certificate = springs_list_certificate(problem, objective, lines)
    if certificate is not None:
        require_accepted(check_own(certificate, problem))
    return certificate


def _searched(objective: Springs, name: str, done: Callable[[str], None]) -> Search:
    made = search(objective, name)
    done(name)
    return made
