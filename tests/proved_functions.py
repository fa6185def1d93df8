"""The functions that return a proved bound or a proof flag, by name, and the tests that judge them.

A function joins this list when it is written. `make rates NAME=mutants` changes each of them in
every place that an operator of `function_mutants.py` knows; some test named here must fail then.
Searches that only propose are not listed: exact arithmetic decides after them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Proved:
    """Functions of a module of `certreg/`, and the modules of `tests/` that judge them."""

    module: str
    functions: tuple[str, ...]
    tests: tuple[str, ...]

    @property
    def file(self) -> str:
        """The path from the root."""
        return f"certreg/{self.module}.py"


def _of(module: str, functions: str, tests: str) -> Proved:
    return Proved(module, tuple(functions.split()), tuple(tests.split()))


PROVED = (
    _of(
        "exact/dyadic",
        "dyadic_above dyadic_below double_above double_below rational_root_above "
        "dyadic_root_above root_above half_angle_bound",
        "exact/test_dyadic",
    ),
    _of("exact/decimals", "at_most at_least _rounded", "exact/test_decimals"),
    _of("exact/dyadic", "degrees_above", "exact/test_decimals"),
    _of("exact/elimination", "is_positive_definite", "exact/test_matrices"),
    _of("exact/balls", "fixed_point radius_bits negative_eigenvalues", "exact/test_balls"),
    _of("exact/spaces", "_narrowest_gap", "exact/test_spaces"),
    _of(
        "certificate/bounds",
        "PoseBounds.share_upper PoseBounds.meet PoseBounds.covers_range PoseBounds.gap_lower "
        "PoseBounds.gap_upper ExactPose.moved pose_bounds flat_energy pose_energy "
        "spring_energy sin2_half_angle_between angle_from",
        "certificate/test_pose_bounds",
    ),
    _of("certificate/truncated", "disproves_labels", "certificate/test_label_sets"),
    _of(
        "certificate/isotropic",
        "proves_optimality _bits_tell proves_basin proved_multiplier proves_multiplier "
        "multiplier_gap _radius",
        "certificate/test_optimality_edges",
    ),
    _of(
        "certificate/bounds",
        "spring_pose_bounds _shift least_range _differences",
        "certificate/test_spring_bound_edges certificate/test_shift_bounds",
    ),
    _of(
        "certificate/basin",
        "barrier_of basin_of_springs",
        "registration/test_flags_enumerated",
    ),
    _of(
        "certificate/radius",
        "isotropic_radius growth_radius _weight_and_lever sines",
        "certificate/test_radius_bounds certificate/test_radius_of_springs",
    ),
    _of("certificate/joint_feasibility", "is_refuted", "certificate/test_pair_edges"),
    _of(
        "certificate/consistency",
        "ExactRows.agree ExactRows.met_by RigidPairs.met_by _at_most",
        "certificate/test_pair_edges",
    ),
    _of(
        "certificate/vertex_elimination",
        "GraphThinning.closed transversal",
        "certificate/test_pair_edges",
    ),
    _of("certificate/proof_stages", "Stager.upper", "certificate/test_pair_edges"),
    _of(
        "certificate/cones",
        "CappedMinimum.floor _curvature _width",
        "certificate/test_pair_edges",
    ),
    _of("certificate/squares", "_moves_all", "certificate/test_pair_edges"),
    _of(
        "certificate/producing_consensus",
        "ProvedConsensus.decided",
        "registration/test_flags_enumerated",
    ),
    _of(
        "certificate/producing_consensus",
        "ProvedConsensus.open_scales",
        "certificate/test_scaled_pairs",
    ),
    _of(
        "certificate/consensus",
        "ConsensusSimilarityBody.met_elsewhere",
        "certificate/test_pair_edges",
    ),
    _of("certificate/listing", "_below", "certificate/test_pair_edges"),
    _of("certificate/listing", "_claimed", "certificate/test_list_produced"),
    _of("certificate/many", "_angles", "certificate/test_pair_edges"),
    _of(
        "objective/classification",
        "Classification.unique Classification.finite Classification.unstable",
        "registration/test_flags_enumerated",
    ),
    _of(
        "objective/isotropic",
        "Isotropic.least_range_squared Isotropic.energy",
        "objective/test_objective",
    ),
    _of(
        "objective/scaling",
        "Scaling.slack Scaling.best Scaling.energy Scaling.energy_at "
        "Scaling.least_range Scaling.gap Scaling.interval Scaling.lost root_bounds "
        "SymmetricScaling.slack SymmetricScaling.best SymmetricScaling.energy "
        "SymmetricScaling.divisor SymmetricScaling.least_range SymmetricScaling.gap "
        "SymmetricScaling.lost",
        "objective/test_scaling_bounds",
    ),
    _of(
        "objective/springs",
        "Springs.energy Springs.oscillation Springs.isotropic_like",
        "objective/test_springs",
    ),
    _of(
        "objective/normalisation",
        "LevelledExactly.is_constant levelled_exactly",
        "objective/test_springs",
    ),
    _of(
        "equilibrium/breaking",
        "energy_is_at_least _splits _eigenline",
        "equilibrium/test_breaking_edges equilibrium/test_breaking_springs",
    ),
    _of(
        "equilibrium/breaking",
        "SpringSet.never_holds SpringSet._most SpringSet._labels "
        "_Residuals.between _Residuals._longest _roots",
        "equilibrium/test_breaking_edges equilibrium/test_breaking_springs",
    ),
    _of(
        "equilibrium/breaking",
        "label_sets _agree",
        "equilibrium/test_breaking_edges equilibrium/test_breaking_springs",
    ),
    _of(
        "equilibrium/breathing",
        "breathing_equilibria BreathingEquilibria.count BreathingEquilibrium.stable",
        "equilibrium/test_breathing_equilibria",
    ),
    _of(
        "equilibrium/line_boxes", "proved_root _krawczyk are_distinct", "equilibrium/test_krawczyk"
    ),
    _of("equilibrium/line_boxes", "index_of", "equilibrium/test_line_edges"),
    _of("equilibrium/line_set", "at_most_forty", "equilibrium/test_line_edges"),
    _of(
        "equilibrium/homotopy",
        "_least proved_lines",
        "equilibrium/test_line_edges equilibrium/test_spring_lists",
    ),
    _of(
        "equilibrium/line_boxes", "BoxedLine.is_real all_different", "equilibrium/test_spring_lists"
    ),
    _of(
        "equilibrium/line_set",
        "infinitely_many _misses _rank_is_below",
        "equilibrium/test_spring_lists",
    ),
    _of("equilibrium/line_set", "LineSet.separated finiteness_of", "equilibrium/test_spring_lists"),
    _of(
        "equilibrium/line_batch",
        "QuarticSolutions.guarantee",
        "registration/test_flags_enumerated",
    ),
    _of("equilibrium/torques", "at_most_four", "certificate/test_count_certificate"),
    _of(
        "equilibrium/critical_set",
        "CriticalSet.complete CriticalSet.guarantee",
        "equilibrium/test_equilibria",
    ),
    _of(
        "equilibrium/equilibrium_set",
        "EquilibriumSet.narrow EquilibriumSet.nearly_ambiguous EquilibriumSet.count _margin",
        "registration/test_flags_enumerated equilibrium/test_equilibria",
    ),
    _of("equilibrium/stability", "_signed", "equilibrium/test_equilibria"),
    _of(
        "registration/breaking",
        "BreakingEquilibrium.stable BreakingEquilibria.complete equilibrium_of _optimum_listed "
        "_fewest",
        "registration/test_flags_enumerated registration/test_breaking_results",
    ),
    _of(
        "registration/breaking",
        "SimulatedBreaking.self_consistent _end",
        "registration/test_flags_enumerated registration/test_breaking_results",
    ),
    _of(
        "registration/robustness",
        "Robustness.of Robustness.with_scales",
        "registration/test_exact_ends registration/test_robustness",
    ),
    _of(
        "registration/rounding",
        "rounding_cost rounding_errors _lever _half",
        "registration/test_exact_ends",
    ),
    _of(
        "registration/scale_range",
        "proved_scales moved_scale moved_symmetric_scale",
        "registration/test_exact_ends",
    ),
    _of("registration/weakly_constrained", "weak_shifts", "registration/test_weakly_constrained"),
    _of(
        "registration/unobservable",
        "Freedom.of Freedom.flat Freedom.moves_optimum Freedom.target_axis "
        "Freedom.source_axis Freedom._alone",
        "registration/test_unobservable",
    ),
    _of(
        "registration/labelled",
        "LabelledRegistration.labels_unique LabelledRegistration.good "
        "ConsensusRegistration.upper ConsensusRegistration.exit_code "
        "ConsensusRegistration.scale_interval",
        "registration/test_flags_enumerated",
    ),
    _of(
        "registration/pair_words",
        "ranges_words",
        "registration/test_flags_enumerated",
    ),
    _of(
        "registration/labelled",
        "TruncatedRegistration.unique TruncatedRegistration.gap "
        "TruncatedRegistration.certified TruncatedRegistration.exit_code",
        "registration/test_flags_enumerated",
    ),
    _of(
        "registration/labelled",
        "TruncatedRegistration.headline",
        "registration/test_truncated_results",
    ),
    _of(
        "registration/label_assessment",
        "TruncatedLabels.differing LabelAssessment.exit_code",
        "registration/test_flags_enumerated",
    ),
    _of(
        "registration/label_assessment",
        "LabelAssessment.headline",
        "registration/test_truncated_labels",
    ),
    _of(
        "registration/label_assessment",
        "KeptPairs.verdict KeptPairs.upper KeptPairs.unique",
        "registration/test_flags_enumerated",
    ),
    _of(
        "registration/equilibria",
        "SpringEquilibrium.stable SpringEquilibria.count "
        "SpringEquilibria.count_complex SpringEquilibria.unique SpringEquilibria.all_optimal "
        "_optimal _margin",
        "registration/test_flags_enumerated",
    ),
    _of(
        "registration/quartic",
        "QuarticSolution.near_minima QuarticSolution.unique_rotation QuarticSolution.unique",
        "registration/test_flags_enumerated registration/test_spring_flags",
    ),
    _of(
        "registration/findings",
        "Findings.is_elsewhere Findings.is_near",
        "registration/test_flags_enumerated",
    ),
    _of(
        "registration/landscape",
        "quartic_rounding_cost",
        "registration/test_spring_flags registration/test_spring_words "
        "registration/test_spring_results laws/test_sums",
    ),
    _of(
        "registration/findings",
        "verdict_of",
        "registration/test_verdicts_of_poses registration/test_spring_flags "
        "registration/test_spring_words registration/test_spring_results",
    ),
    _of(
        "registration/gap_parts",
        "GapParts.doubles _percent",
        "registration/test_exact_ends",
    ),
    _of(
        "registration/valley",
        "SimulatedSprings.as_good SimulatedSprings.converged SimulatedSprings.basin",
        "registration/test_flags_enumerated registration/test_spring_flags "
        "registration/test_valley",
    ),
    _of(
        "registration/equilibria",
        "ScaledEquilibria.finite ScaledEquilibria.count",
        "registration/test_flags_enumerated",
    ),
    _of(
        "registration/result",
        "Registration.status",
        "registration/test_flags_enumerated",
    ),
    _of("registration/headlines", "_meets_usual", "registration/test_flags_enumerated"),
    _of("registration/truncated", "nothing_turned", "registration/test_no_consensus"),
    _of("report/words", "_growth", "report/test_printed_angles"),
    _of("report/document", "_growth", "report/test_printed_angles"),
    _of("report/methods", "_row", "report/test_spring_list_words"),
    _of("report/rest_sections", "is_trap", "report/test_spring_listed"),
    _of("dynamics/body", "certified_basin basin_gaps", "dynamics/test_basin_edges"),
    _of("dynamics/body", "clearly_thick", "dynamics/test_basin_edges"),
    _of("registration/simulation", "never_collapses", "dynamics/test_basin_edges"),
    _of("problem/lifting", "ExactSprings.broken_energy", "equilibrium/test_breaking_springs"),
    _of("problem/bounds", "_require_telling", "problem/test_truncated_problem"),
    _of("problem/bounds", "_require_narrow", "problem/test_bounds"),
    _of("problem/moments", "rounding_of davenport_error", "problem/test_moments"),
)
