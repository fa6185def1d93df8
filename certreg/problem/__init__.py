"""A registration problem: points, weights, and the sums over them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.problem.arrays import as_doubles as as_doubles
    from certreg.problem.arrays import cloud_array as cloud_array
    from certreg.problem.arrays import contiguous as contiguous
    from certreg.problem.arrays import data_frame as data_frame
    from certreg.problem.arrays import finite_doubles as finite_doubles
    from certreg.problem.arrays import first_row as first_row
    from certreg.problem.arrays import mapped_file as mapped_file
    from certreg.problem.arrays import real_numbers as real_numbers
    from certreg.problem.arrays import remedy_of_shape as remedy_of_shape
    from certreg.problem.arrays import row_blocks as row_blocks
    from certreg.problem.bounds import LEAST_PAIRS as LEAST_PAIRS
    from certreg.problem.bounds import MOST_PAIRS as MOST_PAIRS
    from certreg.problem.bounds import bounded as bounded
    from certreg.problem.bounds import checked_bounds as checked_bounds
    from certreg.problem.breaking import ExactSprings as ExactSprings
    from certreg.problem.breaking import exact_springs as exact_springs
    from certreg.problem.effort import checked_effort as checked_effort
    from certreg.problem.effort import checked_threads as checked_threads
    from certreg.problem.exact_sums import FACTORS as FACTORS
    from certreg.problem.exact_sums import UPPER as UPPER
    from certreg.problem.exact_sums import Sums as Sums
    from certreg.problem.exact_sums import second_method as second_method
    from certreg.problem.exact_sums import sums_by as sums_by
    from certreg.problem.floating_springs import FloatingSpringMoments as FloatingSpringMoments
    from certreg.problem.floating_springs import floating_spring_moments as floating_spring_moments
    from certreg.problem.gicp import FrozenInformation as FrozenInformation
    from certreg.problem.gicp import gicp_information as gicp_information
    from certreg.problem.inliers import INLIER_WORDS as INLIER_WORDS
    from certreg.problem.inliers import LEAST_DIRECTIONS as LEAST_DIRECTIONS
    from certreg.problem.inliers import checked_inliers as checked_inliers
    from certreg.problem.lifting import lift as lift
    from certreg.problem.losses import Consensus as Consensus
    from certreg.problem.many import ManyPairs as ManyPairs
    from certreg.problem.many_springs import ManySpringMoments as ManySpringMoments
    from certreg.problem.many_springs import ManySprings as ManySprings
    from certreg.problem.many_springs import many_spring_moments as many_spring_moments
    from certreg.problem.many_springs import stated_many as stated_many
    from certreg.problem.moments import ExactMoments as ExactMoments
    from certreg.problem.moments import Moments as Moments
    from certreg.problem.moments import davenport_error as davenport_error
    from certreg.problem.moments import exact_moments as exact_moments
    from certreg.problem.moments import floating_moments as floating_moments
    from certreg.problem.moments import moments_of_clouds as moments_of_clouds
    from certreg.problem.moments import trace as trace
    from certreg.problem.moments_of_springs import SpringMoments as SpringMoments
    from certreg.problem.moments_of_springs import spring_moments as spring_moments
    from certreg.problem.motion import DEFAULT_DAMPING as DEFAULT_DAMPING
    from certreg.problem.motion import MAX_DAMPING as MAX_DAMPING
    from certreg.problem.motion import MIN_DAMPING as MIN_DAMPING
    from certreg.problem.motion import Motion as Motion
    from certreg.problem.motion import Scale as Scale
    from certreg.problem.motion import checked_damping as checked_damping
    from certreg.problem.motion import checked_rotation_only as checked_rotation_only
    from certreg.problem.motion import checked_scale as checked_scale
    from certreg.problem.posing import FloatingPose as FloatingPose
    from certreg.problem.posing import PosedPairs as PosedPairs
    from certreg.problem.posing import floating_pose as floating_pose
    from certreg.problem.problem import RegistrationProblem as RegistrationProblem
    from certreg.problem.random_instances import PAPER_DAMPING as PAPER_DAMPING
    from certreg.problem.random_instances import PAPER_POINTS as PAPER_POINTS
    from certreg.problem.random_instances import PAPER_SIGMA as PAPER_SIGMA
    from certreg.problem.random_instances import Instances as Instances
    from certreg.problem.random_instances import OutlierInstance as OutlierInstance
    from certreg.problem.random_instances import gaussian_instances as gaussian_instances
    from certreg.problem.random_instances import outlier_instance as outlier_instance
    from certreg.problem.row_labels import LABEL as LABEL
    from certreg.problem.row_labels import RowLabels as RowLabels
    from certreg.problem.row_labels import labels_of as labels_of
    from certreg.problem.row_labels import require_same_labels as require_same_labels
    from certreg.problem.row_lengths import apart as apart
    from certreg.problem.row_lengths import diameter as diameter
    from certreg.problem.row_lengths import lengths as lengths
    from certreg.problem.spring_rows import SPRING_COLUMNS as SPRING_COLUMNS
    from certreg.problem.spring_rows import held_by as held_by
    from certreg.problem.spring_rows import held_rows as held_rows
    from certreg.problem.spring_rows import require_not_of_source as require_not_of_source
    from certreg.problem.spring_rows import unused_springs as unused_springs
    from certreg.problem.spring_rows import warn_of_unused as warn_of_unused
    from certreg.problem.springs import GivenSprings as GivenSprings
    from certreg.problem.springs import SpringSummary as SpringSummary
    from certreg.problem.support import Cell as Cell
    from certreg.problem.support import Loss as Loss
    from certreg.problem.support import Verb as Verb
    from certreg.problem.support import refusal as refusal
    from certreg.problem.support import require_supported as require_supported
    from certreg.problem.terms import Pairs as Pairs

__getattr__ = lazy_face(
    __name__,
    {
        "arrays": (
            "as_doubles",
            "cloud_array",
            "contiguous",
            "data_frame",
            "finite_doubles",
            "first_row",
            "mapped_file",
            "real_numbers",
            "remedy_of_shape",
            "row_blocks",
        ),
        "bounds": ("LEAST_PAIRS", "MOST_PAIRS", "bounded", "checked_bounds"),
        "breaking": (
            "ExactSprings",
            "exact_springs",
        ),
        "effort": ("checked_effort", "checked_threads"),
        "exact_sums": (
            "FACTORS",
            "UPPER",
            "Sums",
            "second_method",
            "sums_by",
        ),
        "floating_springs": (
            "FloatingSpringMoments",
            "floating_spring_moments",
        ),
        "gicp": (
            "FrozenInformation",
            "gicp_information",
        ),
        "inliers": ("INLIER_WORDS", "LEAST_DIRECTIONS", "checked_inliers"),
        "row_lengths": ("apart", "diameter", "lengths"),
        "lifting": ("lift",),
        "many": ("ManyPairs",),
        "many_springs": (
            "ManySpringMoments",
            "ManySprings",
            "many_spring_moments",
            "stated_many",
        ),
        "losses": ("Consensus",),
        "motion": (
            "DEFAULT_DAMPING",
            "MAX_DAMPING",
            "MIN_DAMPING",
            "checked_damping",
            "Motion",
            "Scale",
            "checked_rotation_only",
            "checked_scale",
        ),
        "moments": (
            "ExactMoments",
            "Moments",
            "davenport_error",
            "exact_moments",
            "floating_moments",
            "moments_of_clouds",
            "trace",
        ),
        "moments_of_springs": (
            "SpringMoments",
            "spring_moments",
        ),
        "posing": (
            "FloatingPose",
            "PosedPairs",
            "floating_pose",
        ),
        "problem": ("RegistrationProblem",),
        "random_instances": (
            "Instances",
            "OutlierInstance",
            "PAPER_DAMPING",
            "PAPER_POINTS",
            "PAPER_SIGMA",
            "gaussian_instances",
            "outlier_instance",
        ),
        "row_labels": (
            "LABEL",
            "RowLabels",
            "labels_of",
            "require_same_labels",
        ),
        "spring_rows": (
            "SPRING_COLUMNS",
            "held_by",
            "held_rows",
            "require_not_of_source",
            "unused_springs",
            "warn_of_unused",
        ),
        "springs": (
            "GivenSprings",
            "SpringSummary",
        ),
        "support": (
            "Cell",
            "Loss",
            "Verb",
            "refusal",
            "require_supported",
        ),
        "terms": ("Pairs",),
    },
)
