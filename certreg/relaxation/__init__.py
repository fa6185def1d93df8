"""Semidefinite relaxations, of the rotation problem and of a quartic: what other methods solve."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.relaxation.conic import RelaxationStatus as RelaxationStatus
    from certreg.relaxation.quartic import QuarticRelaxation as QuarticRelaxation
    from certreg.relaxation.quartic import relax_quartic as relax_quartic
    from certreg.relaxation.shor import Relaxation as Relaxation
    from certreg.relaxation.shor import relax as relax

__getattr__ = lazy_face(
    __name__,
    {
        "conic": ("RelaxationStatus",),
        "quartic": (
            "QuarticRelaxation",
            "relax_quartic",
        ),
        "shor": (
            "Relaxation",
            "relax",
        ),
    },
)
