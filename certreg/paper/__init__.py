"""The paper's experiments, figures and claims with verdicts, for the command line alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.paper.counterexamples import certified_clouds as certified_clouds
    from certreg.paper.derivation import all_hold as all_hold
    from certreg.paper.derivation import audit as audit
    from certreg.paper.derivation import chapters as chapters
    from certreg.paper.derivation import outcomes as outcomes
    from certreg.paper.derivation import paper_claims as paper_claims
    from certreg.paper.derivation import write_code as write_code
    from certreg.paper.derivation import write_latex as write_latex
    from certreg.paper.documents import closing_text as closing_text
    from certreg.paper.documents import texts as texts
    from certreg.paper.figures import paper_drawings as paper_drawings
    from certreg.paper.monte_carlo import EXCEPTIONS as EXCEPTIONS
    from certreg.paper.monte_carlo import MonteCarlo as MonteCarlo
    from certreg.paper.monte_carlo import Totals as Totals
    from certreg.paper.monte_carlo import write_instance_results as write_instance_results
    from certreg.paper.observations import Setup as Setup
    from certreg.paper.page import make_folder as make_folder
    from certreg.paper.page import write_reproduction as write_reproduction
    from certreg.paper.parameter_sweeps import all_sweeps as all_sweeps
    from certreg.paper.spring_campaign import SpringCampaign as SpringCampaign
    from certreg.paper.spring_campaign import write_spring_results as write_spring_results
    from certreg.paper.spring_figures import spring_drawings as spring_drawings
    from certreg.paper.spring_maps import SPRING_INSTANCES as SPRING_INSTANCES
    from certreg.paper.spring_maps import RunEnd as RunEnd
    from certreg.paper.spring_maps import SpringCounts as SpringCounts
    from certreg.paper.spring_maps import spring_counts as spring_counts
    from certreg.paper.style import written as written
    from certreg.paper.sweep_figures import sweep_drawings as sweep_drawings
    from certreg.paper.terminal import audit_lines as audit_lines
    from certreg.paper.terminal import chapters_text as chapters_text
    from certreg.paper.terminal import claim_line as claim_line
    from certreg.paper.terminal import closing_line as closing_line
    from certreg.paper.verdicts import reproduce as reproduce

__getattr__ = lazy_face(
    __name__,
    {
        "counterexamples": ("certified_clouds",),
        "derivation": (
            "all_hold",
            "audit",
            "chapters",
            "outcomes",
            "paper_claims",
            "write_code",
            "write_latex",
        ),
        "documents": (
            "closing_text",
            "texts",
        ),
        "figures": ("paper_drawings",),
        "monte_carlo": (
            "EXCEPTIONS",
            "MonteCarlo",
            "Totals",
            "write_instance_results",
        ),
        "observations": ("Setup",),
        "page": (
            "make_folder",
            "write_reproduction",
        ),
        "parameter_sweeps": ("all_sweeps",),
        "spring_campaign": (
            "SpringCampaign",
            "write_spring_results",
        ),
        "spring_figures": ("spring_drawings",),
        "spring_maps": (
            "RunEnd",
            "SPRING_INSTANCES",
            "SpringCounts",
            "spring_counts",
        ),
        "style": ("written",),
        "sweep_figures": ("sweep_drawings",),
        "terminal": (
            "audit_lines",
            "chapters_text",
            "claim_line",
            "closing_line",
        ),
        "verdicts": ("reproduce",),
    },
)
