"""Problems of a few points, each chosen for what is said of it; `net_shown.py` shows them.

One row that is wrong, two, three, four, twelve; with names and without; one optimum, a circle, a
plane of them; each unit and its inverse; each reason why something is not known. To add one, write
it into `problems` with the options of `certify`, and `make record`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from corpus import ROWS, stretched
from net_inputs import LABELS, SHIFT, TILT, TURN, clouds, rounded
from scipy.spatial.transform import Rotation

from certreg import RegistrationProblem

UNITS = (10.0, 0.1, 1000.0, 0.001, 25.4, 1 / 25.4, 0.3048, 1 / 0.3048)
ALONE: dict[str, Any] = {"relaxation": False, "simulation": False}


@dataclass(frozen=True)
class World:
    """A problem and how it is certified; labels of its rows, where they have some."""

    source: Any
    target: Any
    stated: dict[str, Any] = field(default_factory=dict[str, Any])
    labels: list[Any] | None = None
    certified: dict[str, Any] = field(default_factory=lambda: dict(ALONE))

    @property
    def problem(self) -> RegistrationProblem:
        return RegistrationProblem(self.source, self.target, **self.stated)


def moved(points: Any, noise: float = 0.0, seed: int = 1) -> Any:
    """A cloud a quarter turn and a tilt on, exact or with noise."""
    points = np.asarray(points, float)
    target = points @ (TILT @ TURN).T + SHIFT
    return rounded(target + noise * np.random.default_rng(seed).normal(size=points.shape))


def spoiled(target: Any, *rows: int) -> Any:
    """A cloud with rows that are wrong, each another way."""
    wrong = np.array(target, float)
    for k, row in enumerate(rows):
        wrong[row] += np.roll([9.0 + k, -7.0, 5.0 - 2.0 * k], k)
    return wrong


@cache
def worlds(group: str) -> dict[str, World]:
    """All worlds of a group, by name."""
    groups = {"rows": _rows, "scales": _scales, "noise": _noise, "ties": _ties, "sizes": _sizes}
    return groups[group]() if group in groups else _patterns()


def _rows() -> dict[str, World]:
    """Rows that are wrong, or in another order."""
    cloud, noisy, rng = clouds()["cloud"], clouds()["noisy"], np.random.default_rng(7)
    many = rounded(rng.normal(size=(40, 3)) * [3.0, 2.0, 1.0])
    seen, t = moved(many, 0.02), np.arange(24.0)
    curve = rounded(np.column_stack([3.0 * np.cos(t / 5), 3.0 * np.sin(t / 5), t / 4]))
    axis = np.outer(np.arange(-3.0, 4.0), [0.0, 0.0, 2.0])
    ends = rounded(rng.normal(size=(6, 3)) * [3.0, 2.0, 1.0])
    twice = np.vstack([axis, ends[:3] @ TURN.T, ends[3:] @ TURN])
    names = [f"C{k}" for k in range(40)]
    return {
        "one row": World(cloud, spoiled(noisy, 4)),
        "one row named": World(cloud, spoiled(noisy, 4), labels=LABELS),
        "two rows": World(cloud, spoiled(noisy, 4, 9)),
        "three rows named": World(cloud, spoiled(noisy, 1, 4, 9), labels=LABELS),
        "four rows": World(many, spoiled(seen, 1, 4, 9, 30)),
        "four rows named": World(many, spoiled(seen, 1, 4, 9, 30), labels=names),
        "eleven rows": World(many, spoiled(seen, *range(3, 36, 3))),
        "twelve rows": World(many, spoiled(seen, *range(3, 39, 3)), labels=names),
        "some names": World(cloud, noisy, labels=[*LABELS[:11], 3]),
        "many names": World(many, seen, labels=names),
        "on two poses": World(np.vstack([axis, ends]), twice),
        "later": World(curve, np.roll(moved(curve, 0.01), -1, axis=0)),
        "earlier": World(cloud, np.roll(noisy, 1, axis=0)),
        "reversed": World(cloud, noisy[::-1]),
        "shuffled": World(cloud, clouds()["shuffled"], {"sigma": 0.02}),
        "curve shuffled": World(curve, moved(curve)[np.random.default_rng(3).permutation(24)]),
        "mirrored": World(cloud, noisy * [1.0, -1.0, 1.0], {"sigma": 0.02}),
        "unlike": World(cloud, clouds()["unlike"]),
        "a row and a scale": World(cloud, 2.0 * spoiled(noisy, 4)),
    }


def _scales() -> dict[str, World]:
    """Targets of another size."""
    cloud, exact, noisy = clouds()["cloud"], clouds()["moved"], clouds()["noisy"]
    far = {f"times {unit:.6g}": World(cloud, unit * noisy) for unit in UNITS}
    return {
        **far,
        "half": World(cloud, 0.5 * noisy),
        "a little larger": World(cloud, 1.0003 * exact),
        "a little smaller": World(cloud, 0.9998 * exact),
        "a tenth": World(cloud, 1.099 * noisy),
        "more than a tenth": World(cloud, 1.101 * noisy),
        "poorly": World(cloud, 1.3 * clouds()["noisier"]),
        "with sigma": World(cloud, 1.04 * noisy, {"sigma": 0.02}),
        "beyond": World(clouds()["axes"] * 1e-170, clouds()["turned"] * 1e150),
        "below": World(clouds()["axes"] * 1e150, clouds()["turned"] * 1e-170),
    }


def _noise() -> dict[str, World]:
    """What is known of the noise, and what is not."""
    cloud, noisy = clouds()["cloud"], clouds()["noisy"]
    three, ten = cloud[:3], cloud[:10]
    uneven = np.array([1.0, 2.0, 3.0] * 4)
    flat = cloud * [1.0, 1.0, 0.0]
    away = cloud + np.array([3.0e8, 0.0, 0.0])
    return {
        "fine": World(cloud, noisy, {"sigma": 0.02}),
        "half of it": World(cloud, noisy, {"sigma": 0.007}),
        "far too large": World(cloud, noisy, {"sigma": 1.5}),
        "ten times": World(cloud, noisy, {"sigma": 11.0}),
        "a turn": World(cloud, noisy, {"sigma": 1.1}),
        "coarse": World(cloud, clouds()["noisier"], {"sigma": 0.6}),
        "arc seconds": World(1000.0 * cloud, 1000.0 * noisy + 0.5, {"sigma": 0.02}),
        "each its own": World(cloud, noisy, {"sigma": 0.01 * uneven}),
        "weights": World(cloud, noisy, {"weights": uneven}),
        "no weight": World(cloud, noisy, {"weights": np.array([0.0, 1.0, 1.0] * 4)}),
        "few carry": World(cloud, noisy, {"weights": np.array([1e6, 1.0, 1.0] * 4)}),
        "few carry, sure": World(cloud, noisy, {"sigma": np.array([1e-3, 1.0, 1.0] * 4)}),
        "two weighed": World(three, moved(three, 0.01), {"weights": [1.0, 1.0, 0.0]}),
        "three": World(three, moved(three, 0.01)),
        "three, exact": World(three, moved(three)),
        "three with sigma": World(three, moved(three, 0.01), {"sigma": 0.01}),
        "two": World(cloud[:2], moved(cloud[:2], 0.01), {"sigma": 0.01}),
        "one": World(cloud[:1], moved(cloud[:1]), {"sigma": 0.01}),
        "exact": World(ten, moved(ten), {"sigma": 0.01}),
        "flat": World(flat, moved(flat, 0.01), {"sigma": 0.01}),
        "far away": World(away, moved(away, 0.1), {"sigma": 1e-9}),
        "far away, large": World(away, moved(away, 0.1), {"sigma": 0.05}),
        "large": World(1e7 * cloud, 1e7 * noisy, {"sigma": 2e5}),
        "huge": World(1e150 * cloud, 1e150 * noisy, {"sigma": 2e148}),
        "tiny": World(1e-9 * cloud, 1e-9 * noisy, {"sigma": 2e-11}),
    }


def _ties() -> dict[str, World]:
    """Another pose that is nearly as good; turns that nothing fixes."""
    needle = np.array(stretched(4, 2.0**-4, 2.0**-5))
    quiet, rod = moved(needle, 2.0**-12), np.column_stack([np.linspace(-4, 4, 9), np.zeros((9, 2))])
    rod[:, 1] = [0.0, 1e-3, 0.0, -1e-3, 0.0, 1e-3, 0.0, 0.0, 0.0]
    short, narrow = clouds()["short"], clouds()["narrow"]
    exact = needle @ TURN.T
    return {
        "needle": World(needle, quiet),
        "needle, sure": World(needle, quiet, {"sigma": 2.0**-12}),
        "needle, unsure": World(needle, quiet, {"sigma": 0.1}),
        "needle, scaled": World(needle, 1.002 * exact),
        "needle, scaled and sure": World(needle, 1.002 * exact, {"sigma": 2.0**-10}),
        "needle, a row": World(needle, spoiled(quiet, 2)),
        "rod": World(rod, moved(rod, 0.02)),
        "rod, sure": World(rod, moved(rod, 0.02), {"sigma": 0.02}),
        "narrow": World(short, narrow),
        "narrow, sure": World(short, narrow, {"sigma": 1e-3}),
        "narrow, a row": World(short, spoiled(narrow, 1)),
    }


def _sizes() -> dict[str, World]:
    """Bounds that are wide, limits that were moved, and numbers of every size."""
    axes, turned = clouds()["axes"], clouds()["turned"]
    far, line = 1e16 * np.array([1.0, 1.0, 1.0]), np.outer(np.arange(4.0), [1.0, 2.0, 3.0])
    wide = {**ALONE, "max_gap": 0.99, "max_angle": 3.0}
    cloud, one = clouds()["cloud"], np.array([[0.1, 0.2, 0.3]])
    return {
        "far": World(cloud, clouds()["moved"] + far),
        "far, limits moved": World(cloud, clouds()["moved"] + far, certified=wide),
        "both far": World(cloud + far, clouds()["moved"] + far),
        "a line far": World(line, line + far / 8),
        "a line far, limits moved": World(line, line + far / 16, certified=wide),
        "a point far": World(one, one + far),
        "a point far, limits moved": World(one, one + far, certified=wide),
        "points far": World(np.vstack([one] * 3), np.vstack([one] * 3) + far * 3),
        "target small": World(axes, 1e-20 * turned),
        "source small": World(1e-20 * axes, turned),
        "both small": World(1e-155 * axes, 1e-155 * turned),
        "both large": World(1e152 * axes, 1e152 * turned),
        "at rest": World(axes, axes + np.array([1.0, 2.0, 3.0])),
        "more than half a turn": World(axes, moved(moved(moved(axes)))),
    }


def _patterns() -> dict[str, World]:
    """Every kind of set of equilibria, with the motion where there is one."""
    run = {"relaxation": False}
    found = {
        name: World(np.array(pair[0], float), np.array(pair[1], float), {"damping": 2.0}, None, run)
        for name, pair in ROWS.items()
    }
    flipped = World(clouds()["axes"], clouds()["half"], {"damping": 2.0}, None, {})
    plain = World(clouds()["axes"], clouds()["turned"], {"damping": 2.0}, LABELS[:6], {})
    small, large = (
        World(size * clouds()["axes"], size * clouds()["turned"], {"damping": 2.0}, None, run)
        for size in (2.0**-30, 2.0**30)
    )
    euler = World(plain.source, plain.target, plain.stated, None, {**run, "simulation": "euler"})
    tilted = World(plain.source, moved(plain.source), plain.stated, None, run)
    sizes = {"small": small, "large": large, "euler": euler, "tilted": tilted}
    return {"plain": plain, **found, "half a turn": flipped, **sizes}


def poses() -> dict[str, tuple[Any, Any]]:
    """Poses as other tools return them, wrong in one way each; of clouds as `moved` moves them."""
    right = TILT @ TURN
    middle = clouds()["cloud"].mean(axis=0)
    xyzw = Rotation.from_matrix(right).as_quat()
    wxyz = np.roll(xyzw, 1)
    units = {
        f"{unit:g} times {k} the shift": (right, SHIFT * unit**k)
        for unit in (1000.0, 100.0, 10.0, 25.4, 0.3048)
        for k in (1, -1)
    }
    return {
        **units,
        "right": (right, SHIFT),
        "quaternion": (wxyz, SHIFT),
        "scalar last": (xyzw, SHIFT),
        "scalar last alone": (xyzw, None),
        "scalar last, best shift": (xyzw, _best(xyzw)),
        "scalar first": (np.roll(wxyz, 1), SHIFT),
        "scalar first alone": (np.roll(wxyz, 1), None),
        "inverse": (right.T, -right.T @ SHIFT),
        "inverse quaternion": (wxyz * [1.0, -1.0, -1.0, -1.0], -right.T @ SHIFT),
        "inverse alone": (right.T, None),
        "transposed": (right.T, SHIFT),
        "transposed quaternion": (wxyz * [1.0, -1.0, -1.0, -1.0], SHIFT),
        "transposed, best shift": (right.T, right @ middle + SHIFT - right.T @ middle),
        "doubled": (2.0 * right, SHIFT),
        "doubled whole": (2.0 * right, 2.0 * SHIFT),
        "doubled alone": (2.0 * right, None),
        "doubled quaternion": (2.0 * wxyz, SHIFT),
        "few digits": (1.0001 * right, SHIFT),
        "sheared": (right @ np.array([[1.0, 0.2, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), SHIFT),
        "reflected": (right * [1.0, 1.0, -1.0], SHIFT),
        "centred": (right, np.zeros(3)),
        "centred source": (right, SHIFT + right @ middle),
        "centred target": (right, -right @ middle),
        "three decimals": (right.round(3), SHIFT),
        "shifted": (right, SHIFT + np.array([0.0, 0.5, 0.0])),
        "shifted a little": (right, SHIFT + np.array([0.0, 0.02, 0.0])),
        "turned a little": (right @ Rotation.from_rotvec([0.0, 0.004, 0.0]).as_matrix(), SHIFT),
        "turned": (right @ Rotation.from_rotvec([0.3, 0.0, 0.2]).as_matrix(), SHIFT),
        "turned alone": (right @ Rotation.from_rotvec([0.3, 0.0, 0.2]).as_matrix(), None),
    }


def _best(xyzw: Any) -> Any:
    """The translation that takes one centroid to the other, of a quaternion read wrongly."""
    middle = clouds()["cloud"].mean(axis=0)
    return TILT @ TURN @ middle + SHIFT - Rotation.from_quat(np.roll(xyzw, -1)).as_matrix() @ middle
