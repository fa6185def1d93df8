"""Columns `sigma` and `weight` of a user's cloud, where nobody asked for them."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from certreg.errors import UnusedNoiseWarning
from certreg.problem.arrays import data_frame

REMEDIES = {  # by the name of the column: that of the attribute, and what uses it
    "sigma": ("sigma", "sigma={}"),
    "weight": ("weights", "weights={}"),
}


def warn_of_unused_noise(source: Any, target: Any, *, depth: int) -> None:
    """A warning for each cloud that holds a sigma or weights, where none were given.

    depth: how many calls are between the user and here.
    """
    for cloud, which in ((source, "source"), (target, "target")):
        for name, (attribute, remedy) in REMEDIES.items():
            place = _place(cloud, name, attribute)
            if place is not None:
                words = (
                    f"{which} has a column {name}, which is not used: all pairs count alike. "
                    f"{remedy.format(which + place)} uses it; give its points alone if "
                    "pairs count alike"
                )
                warnings.warn(words, UnusedNoiseWarning, stacklevel=depth + 2)


def _place(cloud: Any, name: str, attribute: str) -> str | None:
    """How Python reaches the column of this name; None where a cloud has none."""
    if isinstance(cloud, np.ndarray):
        return None
    if data_frame(cloud):
        return f'["{name}"]' if name in list(cloud.columns) else None
    held = getattr(cloud, attribute, None)
    return f".{attribute}" if isinstance(held, np.ndarray) else None
