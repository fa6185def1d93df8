"""Slips that spoil an optimal pose, beside what `assess` names.

Six slips on 200 random problems each: the right one is named, and the pose without it is judged
(nearly) optimal. Random rotations, with their best translation or any, alone, and poses near but
not at a slipped one: none is named. ARGS: another number. Seeds are fixed.
"""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from strategies import random_rotation

from certreg import Pose, assess, register
from certreg.geometry.so3 import rotation_matrix
from certreg.problem.problem import RegistrationProblem
from certreg.registration.findings import GOOD
from certreg.registration.slips import SlipCode

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from certreg.registration.assessed import Assessment

COUNT = 200
SHOWN = 5
WRONG = ("not-an-equilibrium", "spurious-equilibrium", "not-a-rotation")


def problem(rng: np.random.Generator) -> RegistrationProblem:
    """Clouds of 4 to 60 points, noise up to a tenth of the size, offsets, weights, any unit."""
    n = int(rng.integers(4, 60))
    source = rng.normal(size=(n, 3)) * np.exp(rng.uniform(-1.0, 1.0, 3))
    noise = 0.1 * 10.0 ** -rng.uniform(0.0, 4.0)
    target = source @ random_rotation(rng).T + noise * rng.normal(size=(n, 3))
    offset = rng.normal(size=(2, 3)) * 10.0 ** rng.uniform(0.0, 3.0)
    unit = 10.0 ** rng.uniform(-3.0, 3.0)
    weights = 10.0 ** rng.uniform(-1.0, 1.0, n) if rng.random() < 0.3 else None
    clouds = unit * (source + offset[0]), unit * (target + offset[1])
    return RegistrationProblem(*clouds, weights=weights)


def other_tool(stated: RegistrationProblem) -> Pose:
    """The optimum by floating point alone, as any tool finds it."""
    found = register(stated.source, stated.target, stated.weights)
    assert isinstance(found, Pose)
    return found


def means(stated: RegistrationProblem) -> tuple[Any, Any]:
    """Centroids, weighted."""
    shares = stated.weights / stated.weights.sum()
    return shares @ stated.source, shares @ stated.target


def of_quaternion(q: Any) -> Any:
    """The matrix (3, 3) of a unit quaternion w x y z."""
    return np.array(rotation_matrix(tuple(np.asarray(q).tolist())))


def _reordered(stated: RegistrationProblem, rng: np.random.Generator) -> Any:
    """A scalar-last quaternion taken for scalar-first, or the other way round, or its matrix."""
    pose = other_tool(stated)
    w, x, y, z = pose.quaternion_wxyz.tolist()
    q = [[x, y, z, w], [z, w, x, y]][int(rng.integers(2))]
    kind = rng.integers(3)
    if kind == 2:
        return np.array(q)
    turn = of_quaternion(q) if kind else np.array(q)
    shift = pose.translation
    if rng.random() < 0.3:  # the translation made for the wrong rotation
        x_mean, y_mean = means(stated)
        shift = y_mean - of_quaternion(q) @ x_mean
    return turn, shift


def _transposed(stated: RegistrationProblem, rng: np.random.Generator) -> Any:
    pose, (x_mean, y_mean) = other_tool(stated), means(stated)
    if rng.random() < 0.5:
        return pose.rotation.T, pose.translation
    return pose.rotation.T, y_mean - pose.rotation.T @ x_mean  # Kabsch of the transposed moments


def _inverse(stated: RegistrationProblem, rng: np.random.Generator) -> Any:
    back = other_tool(stated).inverse()
    return [back, back.as_matrix(), back.rotation][int(rng.integers(3))]


def _swapped(stated: RegistrationProblem, _: np.random.Generator) -> Any:
    return register(stated.target, stated.source, stated.weights)


def _centred(stated: RegistrationProblem, rng: np.random.Generator) -> Any:
    R, (x, y) = other_tool(stated).rotation, means(stated)
    both = register(stated.source - x, stated.target - y, stated.weights).translation
    return R, [both, y, -R @ x][int(rng.integers(3))]


def _scaled(stated: RegistrationProblem, rng: np.random.Generator) -> Any:
    """A similarity, the rotation alone scaled, or a translation in another unit."""
    pose, (x, y) = other_tool(stated), means(stated)
    s, kind = 10.0 ** rng.uniform(-3.0, 3.0), rng.integers(4)
    if kind == 0:
        return s * pose.rotation, y - s * pose.rotation @ x
    if kind == 1:
        return s * pose.rotation, pose.translation
    if kind == 2:
        return s * pose.as_matrix()[:3]
    return pose.rotation, pose.translation * [1000.0, 0.001, 25.4, 0.01][int(rng.integers(4))]


@dataclass(frozen=True, slots=True, kw_only=True)
class SlipCase:
    """What is done to an optimal pose, and what must be named."""

    name: str
    spoil: Callable[[RegistrationProblem, np.random.Generator], Any]
    code: SlipCode


SLIPS = (
    SlipCase(name="x y z w as w x y z", spoil=_reordered, code=SlipCode.QUATERNION_ORDER),
    SlipCase(name="transposed", spoil=_transposed, code=SlipCode.TRANSPOSED),
    SlipCase(name="inverse", spoil=_inverse, code=SlipCode.INVERSE),
    SlipCase(name="clouds swapped", spoil=_swapped, code=SlipCode.INVERSE),
    SlipCase(name="centred translation", spoil=_centred, code=SlipCode.CENTRED),
    SlipCase(name="scaled", spoil=_scaled, code=SlipCode.SCALED),
)


def judged(case: SlipCase, count: int) -> Iterator[Assessment]:
    """What is said of spoilt poses."""
    for seed in range(count):
        rng = np.random.default_rng([seed, SLIPS.index(case)])
        stated = problem(rng)
        yield assess(stated, case.spoil(stated, rng))


def is_right(case: SlipCase, said: Assessment) -> bool:
    """Whether the verdict is bad, and this slip is named, in words, too."""
    slip = said.slip
    named = slip is not None and slip.code is case.code and slip.words == said.hint
    swapped = "or are the clouds swapped?" in (said.hint or "")
    return (
        named
        and said.verdict.value in WRONG
        and slip is not None
        and slip.verdict in GOOD
        and swapped == (case.code is SlipCode.INVERSE)
    )


def named_of_random(count: int) -> Iterator[tuple[int, str]]:
    """Random rotations, and slipped poses a tenth of a radian off, of which a slip is named."""
    for seed in range(count):
        rng = np.random.default_rng([seed, 1000])
        stated = problem(rng)
        R, (x, y) = random_rotation(rng), means(stated)
        size = float(np.abs(stated.source).max())
        slipped = SLIPS[seed % len(SLIPS)].spoil(stated, rng)
        tilted = _tilted(slipped, rng)
        for name, pose in {
            "alone": R,
            "with its best translation": (R, y - R @ x),
            "with any translation": (R, size * rng.normal(size=3)),
            "scaled": (7.0 * R, size * rng.normal(size=3)),
            "slipped and tilted": tilted,
        }.items():
            said = assess(stated, pose)
            if said.slip is not None:
                yield seed, f"{name}: {said.hint}"


def _tilted(slipped: Any, rng: np.random.Generator) -> Any:
    """The same with its rotation turned by 0.2 radians about any axis."""
    axis = rng.normal(size=3)
    half = 0.1 * axis / np.linalg.norm(axis)
    tilt = of_quaternion([np.cos(0.1), *(np.sin(0.1) / 0.1 * half)])
    if isinstance(slipped, Pose):
        return tilt @ slipped.rotation, slipped.translation
    if isinstance(slipped, tuple):
        turn, shift = slipped
        turn = of_quaternion(turn) if np.shape(turn) == (4,) else turn
        return tilt @ turn, shift
    if np.shape(slipped) == (4,):
        return tilt @ of_quaternion(slipped)
    if np.shape(slipped) == (3, 3):
        return tilt @ slipped
    return tilt @ slipped[:3, :3], slipped[:3, 3]


def _say(line: str) -> None:
    sys.stdout.write(f"{line}\n")


def main(count: int = COUNT) -> int:
    """Measure all; 1 where a slip is missed or another named."""
    right = True
    for case in SLIPS:
        said = list(judged(case, count))
        missed = [one for one in said if not is_right(case, one)]
        verdicts = Counter(one.slip.verdict.value for one in said if one.slip is not None)
        _say(f"{case.name:22} {count - len(missed)} of {count} named; without it {dict(verdicts)}")
        for one in missed[:SHOWN]:
            _say(f"  MISSED: {one.verdict.value}: {one.hint}")
        right &= not missed
    false = list(named_of_random(count))
    _say(f"{'random and tilted':22} {len(false)} named of {5 * count}")
    for seed, words in false[:SHOWN]:
        _say(f"  NAMED: seed {seed}, {words}")
    return int(not (right and not false))


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
