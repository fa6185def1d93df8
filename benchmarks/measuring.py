"""Time by turns, and figures with the bounds that they must keep."""

from __future__ import annotations

import math
import os
import platform
import time
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

SECONDS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"))


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with its unit: `s`, `rad`, `x` for a ratio, or what is counted."""

    value: float
    unit: str

    def __str__(self) -> str:
        if self.unit == "s":
            size, unit = next((p for p in SECONDS if self.value >= p[0]), SECONDS[-1])
            return f"{self.value / size:.3g} {unit}"
        if self.unit == "rad":
            return f"{self.value:.1e} rad"
        return f"{self.value:.1f}x" if self.unit == "x" else f"{self.value:g} {self.unit}"

    def as_json(self) -> dict[str, Any]:
        """The number, null where it is none, and the unit."""
        return {"value": self.value if math.isfinite(self.value) else None, "unit": self.unit}


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """What was measured; `beside` are figures that explain it. Without a bound it claims nothing.

    bound, least: the largest and the smallest `value` that passes, in the same unit.
    """

    what: str
    value: Quantity | None = None
    bound: float | None = None
    least: float | None = None
    beside: dict[str, Quantity] = field(default_factory=dict)

    @property
    def passed(self) -> bool | None:
        """Whether the bounds are kept; None if there is none. A value that is no number fails."""
        if self.value is None or self.bound is self.least is None:
            return None
        above = self.bound is None or self.value.value <= self.bound
        return above and (self.least is None or self.value.value >= self.least)

    def __str__(self) -> str:
        mark = {True: "PASS", False: "FAIL", None: ""}[self.passed]
        value = "" if self.value is None else str(self.value)
        if self.value is not None and self.bound is not None:
            value += f" <= {Quantity(self.bound, self.value.unit)}"
        if self.value is not None and self.least is not None:
            value += f" >= {Quantity(self.least, self.value.unit)}"
        beside = "  ".join(f"{name} {number!s:<8}" for name, number in self.beside.items())
        return f"{mark:<4}  {self.what:<25}{value:<{28 if value else 0}}{beside}".rstrip()

    def as_json(self) -> dict[str, Any]:
        """All of it, for a file."""
        return {
            "what": self.what,
            **(self.value or Quantity(math.nan, "")).as_json(),
            "bound": self.bound,
            "least": self.least,
            "passed": self.passed,
            "beside": {name: number.as_json() for name, number in self.beside.items()},
        }


def fastest(*works: Callable[[], object], rounds: int, seconds: float = 0.02) -> list[float]:
    """Seconds of the fastest call of each work, in so many rounds that go through all of them.

    In each round each work has a turn of at least `seconds`, and so the same chance of a quiet one.
    """
    turns = [[_turn(work, seconds) for work in works] for _ in range(rounds)]
    return [min(times) for times in zip(*turns, strict=True)]


def _turn(work: Callable[[], object], seconds: float) -> float:
    least, now = math.inf, time.perf_counter()
    end = now + seconds
    while least == math.inf or now < end:
        start = time.perf_counter()
        work()
        now = time.perf_counter()
        least = min(least, now - start)
    return least


def machine() -> dict[str, str | int | None]:
    """Where the figures come from."""
    packages = {name: version(name) for name in ("numpy", "scipy")}
    return {
        "cpu": _cpu_model(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        **packages,
    }


def _cpu_model() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    models = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(models, platform.processor() or platform.machine())
