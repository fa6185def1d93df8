"""The energy after the best translation, as a function of the rotation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.objective.classification import Classification as Classification
    from certreg.objective.classification import Pattern as Pattern
    from certreg.objective.isotropic import Isotropic as Isotropic
    from certreg.objective.objective import Objective as Objective
    from certreg.objective.polynomials import PolynomialSystem as PolynomialSystem
    from certreg.objective.springs import Springs as Springs

__getattr__ = lazy_face(
    __name__,
    {
        "classification": (
            "Classification",
            "Pattern",
        ),
        "isotropic": ("Isotropic",),
        "objective": ("Objective",),
        "polynomials": ("PolynomialSystem",),
        "springs": ("Springs",),
    },
)
