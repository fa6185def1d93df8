"""Mutants of `proved_functions` that are no faults, each with its reason."""

from __future__ import annotations

EQUIVALENT: dict[str, str] = {
    "certreg/exact/dyadic.py:double_below: 0.0 -> 1.0": (
        "from infinity every finite number lies the same way"
    ),
    "certreg/exact/dyadic.py:dyadic_root_above: places >= 0 -> places > 0": (
        "a shift by 0 is the same to the left and to the right"
    ),
    "certreg/exact/dyadic.py:dyadic_root_above: 0 -> 1 (4)": (
        "a shift by 0 is the same to the left and to the right"
    ),
    "certreg/exact/dyadic.py:half_angle_bound: sin2_half_angle >= 1 -> sin2_half_angle > 1": (
        "at 1 both ways give pi: the slack of the arc sine is above it"
    ),
    "certreg/exact/dyadic.py:half_angle_bound: 1 -> 2": (
        "between 1 and 2 both ways give pi: the sine is cut at 1"
    ),
    "certreg/exact/dyadic.py:half_angle_bound: 1.0 -> 2.0": (
        "below 1 the root is at most 1: the cut is for the reader"
    ),
}
