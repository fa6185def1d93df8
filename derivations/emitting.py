"""Names for intermediate values of generated code, so that it computes them once."""

from __future__ import annotations

from typing import Any

import sympy

from .notation import Matrix


class NamedValues:
    """Symbols for intermediate values, and the values, in the order in which they were named."""

    def __init__(self) -> None:
        self._values: list[tuple[Any, Any]] = []

    def __call__(self, name: str, value: Any) -> Any:
        """A symbol for a value; a matrix of symbols for a matrix."""
        if hasattr(value, "shape"):
            entries = [self(f"{name}_{k}", value[k]) for k in range(len(value))]
            return Matrix(*value.shape, entries)
        symbol = sympy.Dummy(name, real=True)
        self._values.append((symbol, value))
        return symbol

    @property
    def values(self) -> tuple[tuple[Any, Any], ...]:
        """All that was named."""
        return tuple(self._values)
