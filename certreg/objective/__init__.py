"""The energy after the best translation, as a function of the rotation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._faces import lazy_face

if TYPE_CHECKING:
    from certreg.objective.classification import Classification as Classification
    from certreg.objective.classification import classify as classify
    from certreg.objective.classification import with_pattern as with_pattern
    from certreg.objective.energy import alignment as alignment
    from certreg.objective.energy import best_translation as best_translation
    from certreg.objective.energy import potential_energy as potential_energy
    from certreg.objective.energy import translation_energy as translation_energy

__getattr__ = lazy_face(
    __name__,
    {
        "classification": (
            "Classification",
            "classify",
            "with_pattern",
        ),
        "energy": (
            "alignment",
            "best_translation",
            "potential_energy",
            "translation_energy",
        ),
    },
)
