"""Why no motion was found that brings enough pairs within their bounds, and what may help."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.certificate.consistency import consistent_pairs
from certreg.exact.decimals import at_least
from certreg.native.cliques import triangles
from certreg.problem.arrays import lengths
from certreg.problem.bounds import LEAST_PAIRS

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem


ROUNDING = 2.0**-48  # of the sum of two lengths: their difference errs by less


def nothing_met(problem: RegistrationProblem) -> str:
    """Of a motion that shall meet three pairs."""
    motion = "motion with a scale" if problem.scaled else "rigid motion"
    if problem.scaled or triangles(consistent_pairs(problem), (1 << problem.n) - 1).any():
        return (
            f"no {motion} was found that brings {LEAST_PAIRS} pairs within their bounds: all may "
            "be wrong; if right ones may be farther off, give wider bounds, else more --effort"
        )
    return (
        f"no {motion} brings {LEAST_PAIRS} pairs within their bounds: no three of them keep their "
        "distances from each other. All may be wrong; if one cloud is in another unit, give "
        "--scale asymmetric; if right pairs may be farther off, give wider bounds"
    )


def nothing_turned(problem: RegistrationProblem) -> str:
    """Of a rotation that shall have a pair within its bound."""
    sizes = [lengths(points) for points in (problem.source, problem.target)]
    apart = np.abs(sizes[0] - sizes[1])
    apart -= ROUNDING * sizes[0] + ROUNDING * sizes[1]
    if (apart <= problem.bounds).any():
        return (
            "no rotation was found that brings a pair within its bound: give more --effort, or "
            "wider bounds if right pairs may be farther off"
        )
    return (
        "no rotation brings a pair within its bound: the two points of each are at distances from "
        f"the origin that differ by {at_least(float(apart.min()))} or more. If a translation "
        "is to be found, leave out --rotation-only and --objective truncated; if the clouds differ "
        "in scale, bring them to one unit; if right pairs may be that far off, give wider bounds"
    )
