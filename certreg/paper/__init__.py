"""The paper's experiments, figures and claims, with verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._faces import lazy_face

if TYPE_CHECKING:
    from certreg.paper.charts import map_drawings as map_drawings
    from certreg.paper.derivation import all_hold as all_hold
    from certreg.paper.derivation import audit as audit
    from certreg.paper.derivation import chapters as chapters
    from certreg.paper.derivation import outcomes as outcomes
    from certreg.paper.derivation import write_code as write_code
    from certreg.paper.derivation import write_latex as write_latex
    from certreg.paper.drawings import all_drawings as all_drawings
    from certreg.paper.exhibition import make_folder as make_folder
    from certreg.paper.exhibition import write_reproduction as write_reproduction
    from certreg.paper.maps import measured_maps as measured_maps
    from certreg.paper.monte_carlo import EXCEPTIONS as EXCEPTIONS
    from certreg.paper.monte_carlo import MonteCarlo as MonteCarlo
    from certreg.paper.monte_carlo import Totals as Totals
    from certreg.paper.monte_carlo import write_instance_results as write_instance_results
    from certreg.paper.observations import Setup as Setup
    from certreg.paper.reproduction import texts as texts
    from certreg.paper.verdicts import reproduce as reproduce

__getattr__ = lazy_face(
    __name__,
    {
        "charts": ("map_drawings",),
        "derivation": (
            "all_hold",
            "audit",
            "chapters",
            "outcomes",
            "write_code",
            "write_latex",
        ),
        "drawings": ("all_drawings",),
        "exhibition": (
            "make_folder",
            "write_reproduction",
        ),
        "maps": ("measured_maps",),
        "monte_carlo": (
            "EXCEPTIONS",
            "MonteCarlo",
            "Totals",
            "write_instance_results",
        ),
        "observations": ("Setup",),
        "reproduction": ("texts",),
        "verdicts": ("reproduce",),
    },
)
