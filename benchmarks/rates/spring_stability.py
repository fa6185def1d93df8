"""Unstable eigenvalues of the linearised motion beside the proved index, over random families.

    make rates NAME=spring_stability ARGS="[INSTANCES]"

Lists all equilibria of each instance, each with the index that is proved, linearises the motion
there (12 x 12, generated), and counts eigenvalues with positive real part: with the damping of the
body, and with another one, a random positive definite 6 x 6 matrix D in the place of mu M and mu J.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from spring_families import FAMILIES, statement

from certreg.certificate.listing import list_body
from certreg.dynamics.valleys import spring_body
from certreg.equilibrium.paths import critical_lines
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem
from certreg.problem.stiffness import spring_moments

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.valleys import SprungBody


DAMPING = 1.3
INSTANCES, LEAST = 130, 5_000  # of each family; equilibria in all
SIZES = {"plane": 7, "line": 5, "aniso": 4, "gicp": 10, "lidar": 10, "mixed": 6, "wall": 20}
NOISE = {"lidar": 1.0}


@dataclass(slots=True)
class Tally:
    """Equilibria that were looked at; indices that were missed; instances without a list."""

    equilibria: int = 0
    missed: int = 0
    unlisted: int = 0


def unstable_directions(
    moving: SprungBody, q: NDArray[np.float64], drag: NDArray[np.float64] | None = None
) -> int:
    """Eigenvalues with positive real part; drag: another damping, (6, 6), over M."""
    jacobian = moving.jacobian(moving.balanced(q)).copy()
    if drag is not None:
        inverse = np.eye(6)
        inverse[3:, 3:] = np.linalg.inv(moving.inertia)
        jacobian[6:, 6:] += DAMPING * np.eye(6) - inverse @ drag
    return int((np.linalg.eigvals(jacobian).real > 0.0).sum())


def counted(instances: int, families: tuple[str, ...] = tuple(SIZES)) -> Tally:
    """Over that many instances of each family."""
    tally = Tally()
    for family in families:
        for seed in range(instances):
            rng = np.random.default_rng([seed, len(family)])
            made = FAMILIES[family](rng, SIZES[family], NOISE.get(family, 0.1))
            problem = RegistrationProblem(**statement(made))
            _count(problem, rng, tally)
    return tally


def _count(problem: RegistrationProblem, rng: np.random.Generator, tally: Tally) -> None:
    moments = spring_moments(problem)
    objective = Springs.of(problem)
    body = list_body(objective, critical_lines(objective.floating_quartic()[0])).body
    if body is None:
        tally.unlisted += 1
        return
    moving = spring_body(moments, DAMPING)
    for q, index in zip(body.quaternions, body.claims.indices, strict=True):
        place = np.array([float(entry >> 40) for entry in q])
        place /= np.linalg.norm(place)
        root = rng.normal(size=(6, 6))
        drags = (None, root @ root.T + 0.1 * np.eye(6))
        tally.missed += sum(unstable_directions(moving, place, drag) != index for drag in drags)
        tally.equilibria += 1


def main() -> int:
    """Count, print, and whether all is well."""
    found = counted(int(sys.argv[1]) if sys.argv[1:] else INSTANCES)
    sys.stdout.write(
        f"{found.equilibria} equilibria, two dampings each: {found.missed} with another number of "
        f"unstable eigenvalues than the proved index; {found.unlisted} instances without a list\n"
    )
    enough = bool(sys.argv[1:]) or found.equilibria >= LEAST
    return 0 if enough and not found.missed else 1


if __name__ == "__main__":
    sys.exit(main())
