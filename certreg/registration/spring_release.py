"""The equilibria of general springs beside a result, and what a body does that is released there.

Found in doubles where it is a run; what is proved of the list is said by the list.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from certreg.dynamics.simulation import simulate
from certreg.dynamics.valleys import spring_body
from certreg.equilibrium.methods import FINDERS, search
from certreg.errors import DegenerateProblemError
from certreg.native.kernels import MissingLibraryError
from certreg.registration.spring_equilibria import SpringEquilibria, spring_equilibria

if TYPE_CHECKING:
    from typing import Any

    from certreg.equilibrium.line_set import LineSet
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.spring_equilibria import SpringEquilibrium


RELEASED = math.radians(1.0)  # from the equilibrium: far above what runs end within
RETURNED = math.radians(0.1)  # to it: ten times what a run that ends is off


def listed_springs(problem: RegistrationProblem, objective: Springs) -> SpringEquilibria | None:
    """The equilibria by the first method; None where it decides nothing."""
    first, *_ = FINDERS[objective.structure]
    found: Any = search(objective, first).critical
    critical: LineSet | None = found
    return None if critical is None else spring_equilibria(critical, objective, problem)


def returns(
    problem: RegistrationProblem, objective: Springs, part: SpringEquilibrium
) -> bool | None:
    """Whether a body released at rest 1 degree from an equilibrium comes back to it.

    Turned about the first axis of the source, with the translation that is best there. None where
    the equations of motion are not defined or not compiled, or the run did not come to rest.
    """
    w, x, y, z = part.basis[:, 0]
    c, s = math.cos(RELEASED / 2.0), math.sin(RELEASED / 2.0)
    turned = (c * w - s * x, c * x + s * w, c * y + s * z, c * z - s * y)
    try:
        start = spring_body(objective.moments, problem.damping).balanced(turned)
        run = simulate(objective, problem.damping, start=start)
    except (DegenerateProblemError, MissingLibraryError):
        return None
    if not run.at_rest:
        return None
    cosine = min(1.0, abs(float(np.dot(part.basis[:, 0], run.quaternion))))
    return 2.0 * math.acos(cosine) < RETURNED
