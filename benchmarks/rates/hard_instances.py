"""280 hard instances, as users meet them.

What is certified ends with code 0 or 3, whatever the cross-checks do. The simulation of at least 95
of 100 converges, and of each other one it is said why.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from strategies import random_rotation

from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.registration.exit_codes import DONE, NOT_UNIQUE
from certreg.report.summary import registration_summary
from certreg.results import Absent, Optimality

if TYPE_CHECKING:
    from collections.abc import Callable

Clouds = tuple[Any, Any, Any]  # source, target, weights
EACH = 40  # of seven families
CONVERGED = 0.95  # at least, of all
CERTIFIED = (Optimality.CERTIFIED, Optimality.CERTIFIED_NOT_UNIQUE)


def moved(rng: np.random.Generator, x: Any, noise: float) -> Any:
    """The cloud somewhere else, with noise relative to its size."""
    size = float(np.abs(x).max())
    turned = x @ random_rotation(rng).T + 10.0 * size * rng.normal(size=3)
    return turned + noise * size * rng.normal(size=x.shape)


def cad(rng: np.random.Generator) -> Any:
    """A box, a flange with a circle of holes, a cylinder, a thin plate, a bracket, in mm."""
    kind, k = int(rng.integers(5)), int(rng.integers(3, 9))
    angles = 2 * np.pi * np.arange(k) / k
    circle = np.stack([np.cos(angles), np.sin(angles), np.zeros(k)], axis=1)
    if kind == 4:
        return np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) * [10.0, 10.0, 20.0]
    if kind == 0:
        corners = np.array([[i, j, m] for i in (-1, 1) for j in (-1, 1) for m in (-1, 1)])
        return corners * rng.choice([10.0, 25.0, 40.0, 100.0], size=3)
    if kind == 1:
        return np.vstack([60.0 * circle, 25.0 * circle, [[0.0, 0.0, 15.0]]])
    if kind == 2:
        return np.vstack(
            [20.0 * circle, 20.0 * circle + np.array([0.0, 0.0, rng.choice([40.0, 400.0])])]
        )
    grid = np.stack(np.meshgrid(np.arange(k), np.arange(3)), axis=-1).reshape(-1, 2)
    return np.hstack([grid * [12.5, 30.0], rng.choice([0.0, 0.8], size=(len(grid), 1))])


def cad_exact(rng: np.random.Generator) -> Clouds:
    """Turned about a diagonal, and moved: symmetric to the last digit; some are mirrored."""
    x = cad(rng)
    y = x[:, [1, 2, 0]] * np.array([1.0, 1.0, rng.choice([-1.0, 1.0])])
    y = y + rng.integers(-500, 500, size=3)
    return x, y, np.ones(len(x))


def cad_measured(rng: np.random.Generator) -> Clouds:
    x = cad(rng)
    return x, moved(rng, x, 10.0 ** rng.uniform(-6, -2)), np.ones(len(x))


def cad_with_wrong_pairs(rng: np.random.Generator) -> Clouds:
    """A symmetric part, its corners numbered from another one: many poses fit about as well."""
    x = cad(rng)
    return x, moved(rng, np.roll(x, 1, axis=0), 1e-4), np.ones(len(x))


def millimetres_against_metres(rng: np.random.Generator) -> Clouds:
    x = cad(rng) if rng.integers(2) else 100.0 * rng.normal(size=(20, 3))
    y = moved(rng, x, 1e-4)
    return (x, y * 1e-3, np.ones(len(x))) if rng.integers(2) else (x * 1e-3, y, np.ones(len(x)))


def near_mirrored(rng: np.random.Generator) -> Clouds:
    """The mirror image of a cloud that is nearly symmetric: two best poses, nearly equal."""
    x = rng.normal(size=(int(rng.integers(4, 20)), 3)) * [3.0, 1.0, 1.0]
    near = 10.0 ** rng.uniform(-9, -1)
    x[:, 2] = x[:, 1][::-1] + near * rng.normal(size=len(x))
    return x, moved(rng, x * [1.0, 1.0, -1.0], near), np.ones(len(x))


def planar(rng: np.random.Generator) -> Clouds:
    """A survey on flat ground, far from the origin of its grid; some on a line but for noise."""
    x = rng.normal(size=(int(rng.integers(3, 15)), 3)) * [100.0, rng.choice([100.0, 1e-3]), 0.0]
    return (
        x + np.array([5e5, 4e6, 0.0]),
        moved(rng, x, 10.0 ** rng.uniform(-9, -3)),
        np.ones(len(x)),
    )


def weights_over_decades(rng: np.random.Generator) -> Clouds:
    x = rng.normal(size=(int(rng.integers(6, 20)), 3))
    weights = 10.0 ** rng.uniform(-15, 15, size=len(x))
    return x, moved(rng, x, 10.0 ** rng.uniform(-3, -1)), weights


FAMILIES: tuple[Callable[[np.random.Generator], Clouds], ...] = (
    cad_exact,
    cad_measured,
    cad_with_wrong_pairs,
    millimetres_against_metres,
    near_mirrored,
    planar,
    weights_over_decades,
)


@dataclass(frozen=True)
class Outcome:
    """What became of an instance. why: it did not converge, in the words that a user reads."""

    status: Optimality
    code: int
    converged: bool
    why: str

    @property
    def sound(self) -> bool:
        """Whether the code is that of the proof, and nothing is left without a reason."""
        coded = self.status not in CERTIFIED or self.code in (DONE, NOT_UNIQUE)
        return coded and (self.converged or len(self.why.split()) > 2)


def outcome(family: Callable[[np.random.Generator], Clouds], seed: int) -> Outcome:
    """An instance, certified as the command does it."""
    rng = np.random.default_rng([280, FAMILIES.index(family), seed])
    source, target, weights = family(rng)
    registration = certify(RegistrationProblem(source, target, weights=weights))
    trajectory, text = registration.solution.trajectory, registration_summary(registration)
    if isinstance(trajectory, Absent):
        converged, why = False, trajectory.reason
        assert why in text
    else:
        converged = trajectory.converged
        why = "" if converged else text.partition("NOT CONVERGED: ")[2].partition("\n")[0]
    return Outcome(registration.status, registration.exit_code, converged, why)


def main() -> None:
    begun, all_of = time.perf_counter(), list[Outcome]()
    heads = ("certified", "bounded", "code 0", "3", "4", "converged")
    print(f"{'family':28}", *(f"{head:>9}" for head in heads))
    for family in FAMILIES:
        found = [outcome(family, seed) for seed in range(EACH)]
        codes = Counter(each.code for each in found)
        certified = sum(each.status in CERTIFIED for each in found)
        bounded = sum(each.status is Optimality.BOUNDED for each in found)
        converged = sum(each.converged for each in found)
        counts = (certified, bounded, codes[0], codes[3], codes[4], converged)
        print(f"{family.__name__:28}", *(f"{count:9}" for count in counts), flush=True)
        all_of += found
    reasons = Counter(each.why for each in all_of if not each.converged)
    for why, count in reasons.most_common():
        print(f"{count:4} not converged: {why or 'no reason given'}")
    converged = sum(each.converged for each in all_of)
    wrong = [each for each in all_of if not each.sound]
    told = f"{len(all_of)} instances in {time.perf_counter() - begun:.0f} s: {converged} converged"
    print(f"{told}, {len(wrong)} with a code or without a reason that should not be")
    sys.exit(bool(wrong) or converged < CONVERGED * len(all_of))


if __name__ == "__main__":
    main()
