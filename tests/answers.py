"""Solutions that hold something else than was computed."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from certreg.registration.result import Registration


def answered(registration: Registration, **values: Any) -> Registration:
    """The same with other values of what its solution computes when first asked."""
    solution = replace(registration.solution)
    vars(solution).update(values)
    return replace(registration, solution=solution)
