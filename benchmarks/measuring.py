"""Time by turns; figures with the bounds that they must keep; times against a size."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
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
        if self.unit == "x":
            return f"{self.value:.3g}x" if self.value < 1000 else f"{self.value:.0f}x"
        return f"{self.value:.4g} {self.unit}".rstrip()

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
        return f"{mark:<4}  {self.what:<30}  {value:<{28 if value else 0}}  {beside}".rstrip()

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """Seconds of several works against a size; the first line is certreg's.

    size: what the sizes count. lines: name to size to seconds; not every line has every size.
    """

    what: str
    size: str
    lines: dict[str, dict[int, float]]

    def __str__(self) -> str:
        """A table: the seconds of the first line, and how many times those the others take."""
        sizes = sorted({size for times in self.lines.values() for size in times})
        ours = next(iter(self.lines.values()))
        rows = [(self.what, [power_of_ten(size) for size in sizes])]
        for name, times in self.lines.items():
            shared = times.keys() & ours.keys()
            ratios = {size: Quantity(times[size] / ours[size], "x") for size in shared}
            cells = [str(ratios.get(size, "")) for size in sizes]
            if times is ours:
                cells = [str(Quantity(ours[size], "s")) if size in ours else "" for size in sizes]
            rows.append((name, cells))
        return "\n".join(
            f"      {name:<26}" + "".join(f"{cell:>9}" for cell in cells) for name, cells in rows
        )

    def as_json(self) -> dict[str, Any]:
        """All of it, for a file."""
        lines = [
            {"name": name, "sizes": list(times), "seconds": list(times.values())}
            for name, times in self.lines.items()
        ]
        return {"what": self.what, "size": self.size, "lines": lines}


def power_of_ten(size: int) -> str:
    """The size as people write it.

    >>> power_of_ten(10_000_000), power_of_ten(64), power_of_ten(10)
    ('10⁷', '64', '10')
    """
    digits = str(size)
    if digits.rstrip("0") == "1" and size > 10:
        return "10" + str(len(digits) - 1).translate(SUPERSCRIPTS)
    return digits


def exponent(times: dict[int, float]) -> float:
    """The slope of a straight line through the logarithms: 1 where cost is linear in size."""
    sizes, seconds = ([math.log(v) for v in values] for values in (times, times.values()))
    middle, level = math.fsum(sizes) / len(sizes), math.fsum(seconds) / len(seconds)
    along = math.fsum((a - middle) * (b - level) for a, b in zip(sizes, seconds, strict=True))
    return along / math.fsum((a - middle) ** 2 for a in sizes)


def fastest(
    *works: Callable[[], object],
    rounds: int,
    seconds: float = 0.02,
    clock: Callable[[], float] = time.perf_counter,
) -> list[float]:
    """Seconds of the fastest call of each work, in so many rounds that go through all of them.

    In each round each work has a turn of at least `seconds`, and so the same chance of a quiet one.
    clock: `time.process_time` where other work on the machine shall not count.
    """
    turns = [[_turn(work, seconds, clock) for work in works] for _ in range(rounds)]
    return [min(times) for times in zip(*turns, strict=True)]


def _turn(work: Callable[[], object], seconds: float, clock: Callable[[], float]) -> float:
    least, now = math.inf, clock()
    end = now + seconds
    while least == math.inf or now < end:
        start = clock()
        work()
        now = clock()
        least = min(least, now - start)
    return least
