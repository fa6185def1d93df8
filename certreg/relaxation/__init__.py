"""The semidefinite relaxation of the rotation problem: what other methods of registration solve."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.relaxation.shor import Relaxation as Relaxation
    from certreg.relaxation.shor import relax as relax

__getattr__ = lazy_face(
    __name__,
    {
        "shor": (
            "Relaxation",
            "relax",
        ),
    },
)
