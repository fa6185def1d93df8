"""Semidefinite relaxations, of the rotation problem and of a quartic: what other methods solve.

And the optimum of general springs that they propose, or else the paths to all critical lines; and
poses with many pairs within their bounds, where some pairs are wrong.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.relaxation.conic import RelaxationStatus as RelaxationStatus
    from certreg.relaxation.consensus_search import candidates as candidates
    from certreg.relaxation.optimum import Found as Found
    from certreg.relaxation.optimum import find_optimum as find_optimum
    from certreg.relaxation.optimum import optimum_of as optimum_of
    from certreg.relaxation.quartic import QuarticRelaxation as QuarticRelaxation
    from certreg.relaxation.quartic import relax_quartic as relax_quartic
    from certreg.relaxation.refining import refined as refined
    from certreg.relaxation.rotation_boxes import BoxSearch as BoxSearch
    from certreg.relaxation.rotation_boxes import search_boxes as search_boxes
    from certreg.relaxation.shor import Relaxation as Relaxation
    from certreg.relaxation.shor import relax as relax
    from certreg.relaxation.similarity_fit import lengths_between as lengths_between
    from certreg.relaxation.similarity_fit import scale_ranges as scale_ranges
    from certreg.relaxation.truncated_squares import Candidate as Candidate
    from certreg.relaxation.truncated_squares import (
        graduated_nonconvexity as graduated_nonconvexity,
    )

__getattr__ = lazy_face(
    __name__,
    {
        "conic": ("RelaxationStatus",),
        "consensus_search": ("candidates",),
        "optimum": (
            "Found",
            "find_optimum",
            "optimum_of",
        ),
        "quartic": (
            "QuarticRelaxation",
            "relax_quartic",
        ),
        "refining": ("refined",),
        "rotation_boxes": (
            "BoxSearch",
            "search_boxes",
        ),
        "shor": (
            "Relaxation",
            "relax",
        ),
        "similarity_fit": ("lengths_between", "scale_ranges"),
        "truncated_squares": (
            "Candidate",
            "graduated_nonconvexity",
        ),
    },
)
