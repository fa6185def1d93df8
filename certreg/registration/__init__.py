"""The main job: register, enumerate, cross-check, certify; and judge other poses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.registration.agreement import Agreement as Agreement
    from certreg.registration.ambiguity import NEARLY_AMBIGUOUS as NEARLY_AMBIGUOUS
    from certreg.registration.ambiguity import ambiguous_words as ambiguous_words
    from certreg.registration.ambiguity import narrow_words as narrow_words
    from certreg.registration.assessed import Assessment as Assessment
    from certreg.registration.assessment import assess as assess
    from certreg.registration.assessment import judged as judged
    from certreg.registration.breaking import BreakingEquilibria as BreakingEquilibria
    from certreg.registration.breaking import BreakingEquilibrium as BreakingEquilibrium
    from certreg.registration.breaking import breaking_equilibria as breaking_equilibria
    from certreg.registration.breaking_simulation import SimulatedBreaking as SimulatedBreaking
    from certreg.registration.breaking_simulation import simulate_breaking as simulate_breaking
    from certreg.registration.breathing import ScaledEquilibria as ScaledEquilibria
    from certreg.registration.breathing import SimulatedBreathing as SimulatedBreathing
    from certreg.registration.breathing import scaled_equilibria as scaled_equilibria
    from certreg.registration.c_sources import write_sources as write_sources
    from certreg.registration.certification import certify as certify
    from certreg.registration.closed_form import horn as horn
    from certreg.registration.closed_form import register as register
    from certreg.registration.consensus import ConsensusRegistration as ConsensusRegistration
    from certreg.registration.consensus import restated_consensus as restated_consensus
    from certreg.registration.consensus_words import are_words as are_words
    from certreg.registration.consensus_words import bound_words as bound_words
    from certreg.registration.covariance import NO_RESIDUALS as NO_RESIDUALS
    from certreg.registration.covariance import PoseCovariance as PoseCovariance
    from certreg.registration.covariance import residual_distances as residual_distances
    from certreg.registration.covariance import worst_residuals as worst_residuals
    from certreg.registration.enumeration import Enumeration as Enumeration
    from certreg.registration.enumeration import ListedEquilibria as ListedEquilibria
    from certreg.registration.enumeration import certified_count as certified_count
    from certreg.registration.enumeration import certified_list as certified_list
    from certreg.registration.enumeration import enumerated as enumerated
    from certreg.registration.enumeration import equilibria as equilibria
    from certreg.registration.enumeration import equilibrium_poses as equilibrium_poses
    from certreg.registration.examples import STORIES as STORIES
    from certreg.registration.examples import TWIN_MOTIONS as TWIN_MOTIONS
    from certreg.registration.examples import differences as differences
    from certreg.registration.examples import stated as stated
    from certreg.registration.examples import tell as tell
    from certreg.registration.exit_codes import DEFECT as DEFECT
    from certreg.registration.exit_codes import DONE as DONE
    from certreg.registration.exit_codes import INTERRUPTED as INTERRUPTED
    from certreg.registration.exit_codes import MISUSED as MISUSED
    from certreg.registration.exit_codes import NOT_CERTIFIED as NOT_CERTIFIED
    from certreg.registration.exit_codes import NOT_UNIQUE as NOT_UNIQUE
    from certreg.registration.exit_codes import REFUSED as REFUSED
    from certreg.registration.exit_codes import FitDemands as FitDemands
    from certreg.registration.exit_codes import code_of_error as code_of_error
    from certreg.registration.exit_codes import code_of_registration as code_of_registration
    from certreg.registration.exit_codes import worst as worst
    from certreg.registration.findings import FIT_WARNED as FIT_WARNED
    from certreg.registration.findings import GOOD as GOOD
    from certreg.registration.findings import AssessmentSettings as AssessmentSettings
    from certreg.registration.findings import JudgedEnergies as JudgedEnergies
    from certreg.registration.findings import SigmaDistance as SigmaDistance
    from certreg.registration.fit import Fit as Fit
    from certreg.registration.fit import FitRow as FitRow
    from certreg.registration.fit import fit_of as fit_of
    from certreg.registration.fit import silent_tests as silent_tests
    from certreg.registration.freedom import Freedom as Freedom
    from certreg.registration.headlines import HARDLY_DETERMINED as HARDLY_DETERMINED
    from certreg.registration.headlines import HEADLINES as HEADLINES
    from certreg.registration.headlines import NO_ROTATION as NO_ROTATION
    from certreg.registration.headlines import WEAK as WEAK
    from certreg.registration.headlines import Headline as Headline
    from certreg.registration.headlines import headline_of as headline_of
    from certreg.registration.headlines import headline_words as headline_words
    from certreg.registration.headlines import interval_words as interval_words
    from certreg.registration.headlines import is_green as is_green
    from certreg.registration.headlines import is_loose as is_loose
    from certreg.registration.headlines import proved_degrees as proved_degrees
    from certreg.registration.headlines import share_words as share_words
    from certreg.registration.kept_pairs import KeptPairs as KeptPairs
    from certreg.registration.kept_pairs import LabelsVerdict as LabelsVerdict
    from certreg.registration.kept_pairs import judged_labels as judged_labels
    from certreg.registration.linear import CROSS_CHECK as CROSS_CHECK
    from certreg.registration.linear import LinearSolution as LinearSolution
    from certreg.registration.loose_turns import TooLarge as TooLarge
    from certreg.registration.loose_turns import axis_words as axis_words
    from certreg.registration.loose_turns import beyond_first_order as beyond_first_order
    from certreg.registration.many import certify_many as certify_many
    from certreg.registration.misfits import ChiSquared as ChiSquared
    from certreg.registration.misfits import FitCode as FitCode
    from certreg.registration.misfits import FitWarning as FitWarning
    from certreg.registration.pair_angles import widest_angles as widest_angles
    from certreg.registration.pipeline import NOT_ASKED as NOT_ASKED
    from certreg.registration.pipeline import Asked as Asked
    from certreg.registration.quartic import NOT_LISTED as NOT_LISTED
    from certreg.registration.quartic import NOT_SIMULATED as NOT_SIMULATED
    from certreg.registration.quartic import SPRING_KINDS as SPRING_KINDS
    from certreg.registration.quartic import QuarticSolution as QuarticSolution
    from certreg.registration.result import UNDECIDED as UNDECIDED
    from certreg.registration.result import Method as Method
    from certreg.registration.result import Registration as Registration
    from certreg.registration.result import Solution as Solution
    from certreg.registration.robustness import ROBUSTNESS_ANGLE as ROBUSTNESS_ANGLE
    from certreg.registration.robustness import Robustness as Robustness
    from certreg.registration.rounding import rounding_remedy as rounding_remedy
    from certreg.registration.row_names import RowNames as RowNames
    from certreg.registration.scaled_consensus import (
        ScaledConsensusRegistration as ScaledConsensusRegistration,
    )
    from certreg.registration.scaled_consensus import ranges_words as ranges_words
    from certreg.registration.scaled_consensus import (
        restated_scaled_consensus as restated_scaled_consensus,
    )
    from certreg.registration.scaled_poses import unit_of as unit_of
    from certreg.registration.simulation import ProblemTrajectory as ProblemTrajectory
    from certreg.registration.simulation import SimulatedMotion as SimulatedMotion
    from certreg.registration.simulation import SimulatedRegistration as SimulatedRegistration
    from certreg.registration.simulation import optimally_damped as optimally_damped
    from certreg.registration.simulation import proved_end as proved_end
    from certreg.registration.simulation import simulate as simulate
    from certreg.registration.slips import Slip as Slip
    from certreg.registration.slips import SlipCode as SlipCode
    from certreg.registration.spring_equilibria import (
        ListedSpringEquilibria as ListedSpringEquilibria,
    )
    from certreg.registration.spring_equilibria import SpringEquilibria as SpringEquilibria
    from certreg.registration.spring_equilibria import SpringEquilibrium as SpringEquilibrium
    from certreg.registration.spring_headlines import SPRING_HEADLINES as SPRING_HEADLINES
    from certreg.registration.spring_headlines import free_words as free_words
    from certreg.registration.spring_headlines import is_green_spring as is_green_spring
    from certreg.registration.spring_headlines import spring_degrees as spring_degrees
    from certreg.registration.spring_headlines import spring_headline_of as spring_headline_of
    from certreg.registration.spring_headlines import spring_headline_words as spring_headline_words
    from certreg.registration.spring_release import listed_springs as listed_springs
    from certreg.registration.spring_release import returns as returns
    from certreg.registration.spring_rows import SpringAxes as SpringAxes
    from certreg.registration.squares import BY_NAME as BY_NAME
    from certreg.registration.squares import certified_squares as certified_squares
    from certreg.registration.truncated import TruncatedRegistration as TruncatedRegistration
    from certreg.registration.truncated import restated_truncated as restated_truncated
    from certreg.registration.truncated_labels import TruncatedLabels as TruncatedLabels
    from certreg.registration.truncated_labels import (
        judged_truncated_labels as judged_truncated_labels,
    )
    from certreg.registration.valley import SimulatedSprings as SimulatedSprings
    from certreg.registration.valley import at_end_words as at_end_words
    from certreg.registration.valley import moving_words as moving_words
    from certreg.registration.weak_shifts import weak_shift_words as weak_shift_words

__getattr__ = lazy_face(
    __name__,
    {
        "agreement": ("Agreement",),
        "ambiguity": (
            "NEARLY_AMBIGUOUS",
            "ambiguous_words",
            "narrow_words",
        ),
        "assessed": ("Assessment",),
        "assessment": (
            "assess",
            "judged",
        ),
        "breaking": (
            "BreakingEquilibria",
            "BreakingEquilibrium",
            "breaking_equilibria",
        ),
        "breaking_simulation": (
            "SimulatedBreaking",
            "simulate_breaking",
        ),
        "breathing": (
            "ScaledEquilibria",
            "SimulatedBreathing",
            "scaled_equilibria",
        ),
        "c_sources": ("write_sources",),
        "certification": ("certify",),
        "closed_form": (
            "horn",
            "register",
        ),
        "consensus": ("ConsensusRegistration", "restated_consensus"),
        "consensus_words": ("are_words", "bound_words"),
        "scaled_consensus": (
            "ScaledConsensusRegistration",
            "ranges_words",
            "restated_scaled_consensus",
        ),
        "covariance": (
            "NO_RESIDUALS",
            "PoseCovariance",
            "residual_distances",
            "worst_residuals",
        ),
        "enumeration": (
            "Enumeration",
            "ListedEquilibria",
            "certified_count",
            "certified_list",
            "equilibria",
            "equilibrium_poses",
            "enumerated",
        ),
        "examples": (
            "STORIES",
            "TWIN_MOTIONS",
            "differences",
            "stated",
            "tell",
        ),
        "exit_codes": (
            "DEFECT",
            "DONE",
            "INTERRUPTED",
            "MISUSED",
            "NOT_CERTIFIED",
            "NOT_UNIQUE",
            "REFUSED",
            "FitDemands",
            "code_of_error",
            "code_of_registration",
            "worst",
        ),
        "findings": (
            "AssessmentSettings",
            "GOOD",
            "JudgedEnergies",
            "FIT_WARNED",
            "SigmaDistance",
        ),
        "fit": (
            "Fit",
            "FitRow",
            "fit_of",
            "silent_tests",
        ),
        "freedom": ("Freedom",),
        "headlines": (
            "HARDLY_DETERMINED",
            "HEADLINES",
            "NO_ROTATION",
            "WEAK",
            "Headline",
            "headline_of",
            "headline_words",
            "interval_words",
            "is_green",
            "is_loose",
            "proved_degrees",
            "share_words",
        ),
        "kept_pairs": ("KeptPairs", "LabelsVerdict", "judged_labels"),
        "linear": ("CROSS_CHECK", "LinearSolution"),
        "loose_turns": ("TooLarge", "axis_words", "beyond_first_order"),
        "many": ("certify_many",),
        "misfits": (
            "ChiSquared",
            "FitCode",
            "FitWarning",
        ),
        "pair_angles": ("widest_angles",),
        "pipeline": ("NOT_ASKED", "Asked"),
        "result": (
            "Method",
            "Registration",
            "Solution",
            "UNDECIDED",
        ),
        "robustness": (
            "ROBUSTNESS_ANGLE",
            "Robustness",
        ),
        "rounding": ("rounding_remedy",),
        "row_names": ("RowNames",),
        "scaled_poses": ("unit_of",),
        "simulation": (
            "ProblemTrajectory",
            "SimulatedMotion",
            "SimulatedRegistration",
            "optimally_damped",
            "proved_end",
            "simulate",
        ),
        "slips": (
            "Slip",
            "SlipCode",
        ),
        "spring_equilibria": (
            "ListedSpringEquilibria",
            "SpringEquilibria",
            "SpringEquilibrium",
        ),
        "spring_release": ("listed_springs", "returns"),
        "spring_headlines": (
            "SPRING_HEADLINES",
            "free_words",
            "is_green_spring",
            "spring_degrees",
            "spring_headline_of",
            "spring_headline_words",
        ),
        "quartic": (
            "NOT_LISTED",
            "NOT_SIMULATED",
            "SPRING_KINDS",
            "QuarticSolution",
        ),
        "spring_rows": ("SpringAxes",),
        "squares": ("BY_NAME", "certified_squares"),
        "truncated": ("TruncatedRegistration", "restated_truncated"),
        "truncated_labels": ("TruncatedLabels", "judged_truncated_labels"),
        "valley": (
            "SimulatedSprings",
            "at_end_words",
            "moving_words",
        ),
        "weak_shifts": ("weak_shift_words",),
    },
)
