"""The optimum of general springs: proposed by the relaxation, else the best of all local minima."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.finding.optimum import Found as Found
    from certreg.finding.optimum import find_optimum as find_optimum
    from certreg.finding.optimum import optimum_of as optimum_of
    from certreg.finding.refining import refined as refined

__getattr__ = lazy_face(
    __name__,
    {
        "optimum": (
            "Found",
            "find_optimum",
            "optimum_of",
        ),
        "refining": ("refined",),
    },
)
