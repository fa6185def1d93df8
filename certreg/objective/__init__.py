"""The energy after the best translation, as a function of the rotation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.objective.classification import Classification as Classification
    from certreg.objective.classification import Pattern as Pattern
    from certreg.objective.form import Form as Form
    from certreg.objective.isotropic import Isotropic as Isotropic
    from certreg.objective.levelling import Levelled as Levelled
    from certreg.objective.levelling import LevelledExactly as LevelledExactly
    from certreg.objective.levelling import levelled as levelled
    from certreg.objective.levelling import levelled_exactly as levelled_exactly
    from certreg.objective.levelling import norm_fourth as norm_fourth
    from certreg.objective.neighbourhood import Neighbourhood as Neighbourhood
    from certreg.objective.objective import Objective as Objective
    from certreg.objective.objective import objective_of as objective_of
    from certreg.objective.polynomials import PolynomialSystem as PolynomialSystem
    from certreg.objective.quartics import MONOMIALS as MONOMIALS
    from certreg.objective.quartics import PAIR_PLACE as PAIR_PLACE
    from certreg.objective.quartics import PAIRS as PAIRS
    from certreg.objective.quartics import quartic_of_form as quartic_of_form
    from certreg.objective.scaling import Scaling as Scaling
    from certreg.objective.springs import Springs as Springs
    from certreg.objective.structure import Structure as Structure

__getattr__ = lazy_face(
    __name__,
    {
        "classification": (
            "Classification",
            "Pattern",
        ),
        "form": ("Form",),
        "isotropic": ("Isotropic",),
        "levelling": (
            "Levelled",
            "LevelledExactly",
            "levelled",
            "levelled_exactly",
            "norm_fourth",
        ),
        "neighbourhood": ("Neighbourhood",),
        "objective": ("Objective", "objective_of"),
        "polynomials": ("PolynomialSystem",),
        "quartics": (
            "MONOMIALS",
            "PAIRS",
            "PAIR_PLACE",
            "quartic_of_form",
        ),
        "scaling": ("Scaling",),
        "springs": ("Springs",),
        "structure": ("Structure",),
    },
)
