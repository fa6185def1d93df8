"""Producing the certificates of general springs: of the optimum, and of all equilibria.

A module of its own: what proposes these proofs loads NumPy, which other certificates do without.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from certreg.certificate.cones import ConesProposal, cones_body
from certreg.certificate.listing import list_body
from certreg.certificate.producing import enclosed
from certreg.certificate.radius import growth_radius
from certreg.certificate.squares import sos_body
from certreg.errors import NotCompiledWarning
from certreg.native.kernels import MissingLibraryError

if TYPE_CHECKING:
    from typing import Any

    from certreg.certificate.envelope import Certificate
    from certreg.certificate.springs_cones import SpringsConesBody
    from certreg.certificate.springs_list import SpringsListBody
    from certreg.certificate.springs_sos import SpringsSosBody
    from certreg.equilibrium.paths import CriticalLines
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem
    from certreg.relaxation.optimum import Found

AnyBody = TypeVar("AnyBody", "SpringsSosBody", "SpringsConesBody")


def springs_certificate(
    problem: RegistrationProblem,
    objective: Springs,
    found: Found,
    *,
    robustness_angle: float | None = None,
    about: dict[str, Any] | None = None,
) -> Certificate[SpringsSosBody] | Certificate[SpringsConesBody] | None:
    """A certificate of the optimum that was found, by squares or by cones; None if not proved.

    Cones are cut where squares leave open whether the optimum is unique, and kept where they prove
    more; `about` says then how. robustness_angle: as `produce` takes it.
    None means not proved, not disproved.
    """
    squares = sos_body(objective, found)
    if squares is not None and squares.claims.unique is not None:
        return enclosed(problem, _moving(objective, squares, robustness_angle), about)
    cones = _cones(objective, found)
    body = cones.body
    if body is not None and (squares is None or body.claims.unique or body.gap < squares.gap):
        told = {**(about or {}), "cones": cones.words}
        return enclosed(problem, _moving(objective, body, robustness_angle), told)
    if squares is None:
        return None
    return enclosed(problem, _moving(objective, squares, robustness_angle), about)


def _cones(objective: Springs, found: Found) -> ConesProposal:
    """What cones prove; without compiled code nothing, and a warning says so."""
    try:
        return cones_body(objective, found.minima)
    except MissingLibraryError as error:
        warnings.warn(str(error), NotCompiledWarning, stacklevel=2)
        return ConesProposal(body=None, words=str(error), seen=0)


def springs_list_certificate(
    problem: RegistrationProblem,
    objective: Springs,
    lines: CriticalLines,
    *,
    about: dict[str, Any] | None = None,
) -> Certificate[SpringsListBody] | None:
    """A certificate of all equilibria, from the ends of all 40 paths.

    None means not proved, not disproved: lines are multiple, or nearly so; `list_body` says it.
    """
    body = list_body(objective, lines).body
    return None if body is None else enclosed(problem, body, about)


def _moving(objective: Springs, body: AnyBody, degrees: float | None) -> AnyBody:
    """The same body, with how far the points may move where that is proved and asked for."""
    if degrees is None:
        return body
    radius = growth_radius(
        objective.moments,
        mu=body.growth,
        delta=body.gap,
        value=objective.energy(body.quaternion),
        degrees=degrees,
    )
    return replace(body, radius=radius)
