"""Files of clouds, weights and poses: strict readers, atomic writers. The package loads nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.io.atomic import TEMPORARY as TEMPORARY
    from certreg.io.atomic import remedy_of as remedy_of
    from certreg.io.atomic import require_vacant as require_vacant
    from certreg.io.atomic import write_atomically as write_atomically
    from certreg.io.atomic import write_files as write_files
    from certreg.io.atomic import write_together as write_together
    from certreg.io.atomic import written_atomically as written_atomically
    from certreg.io.bounds import read_bounds as read_bounds
    from certreg.io.clouds import read_cloud as read_cloud
    from certreg.io.inliers import PAIR_COLUMNS as PAIR_COLUMNS
    from certreg.io.inliers import read_inliers as read_inliers
    from certreg.io.labels import Match as Match
    from certreg.io.labels import csv_field as csv_field
    from certreg.io.objects import load as load
    from certreg.io.objects import pair as pair
    from certreg.io.objects import stated_problem as stated_problem
    from certreg.io.pairing import BY_LABEL as BY_LABEL
    from certreg.io.pairing import Pair as Pair
    from certreg.io.pairing import Pairing as Pairing
    from certreg.io.poses import MAX_POSE_BYTES as MAX_POSE_BYTES
    from certreg.io.poses import read_result_pose as read_result_pose
    from certreg.io.problems import read_problem as read_problem
    from certreg.io.springs import OF_COLUMNS as OF_COLUMNS
    from certreg.io.springs import SpringSource as SpringSource
    from certreg.io.standard_input import is_standard_input as is_standard_input
    from certreg.io.streams import Place as Place
    from certreg.io.streams import number as number
    from certreg.io.streams import reading as reading
    from certreg.io.streams import refused as refused
    from certreg.io.streams import require_ending as require_ending
    from certreg.io.text import TEXT_FORMATS as TEXT_FORMATS
    from certreg.io.text import parse_rows as parse_rows
    from certreg.io.text import read_clouds as read_clouds
    from certreg.io.written_clouds import write_cloud as write_cloud

__getattr__ = lazy_face(
    __name__,
    {
        "atomic": (
            "TEMPORARY",
            "remedy_of",
            "require_vacant",
            "write_atomically",
            "write_files",
            "write_together",
            "written_atomically",
        ),
        "bounds": ("read_bounds",),
        "clouds": ("read_cloud",),
        "inliers": ("PAIR_COLUMNS", "read_inliers"),
        "labels": ("Match", "csv_field"),
        "objects": (
            "load",
            "pair",
            "stated_problem",
        ),
        "pairing": ("BY_LABEL", "Pair", "Pairing"),
        "poses": (
            "MAX_POSE_BYTES",
            "read_result_pose",
        ),
        "problems": ("read_problem",),
        "springs": (
            "OF_COLUMNS",
            "SpringSource",
        ),
        "standard_input": ("is_standard_input",),
        "streams": (
            "Place",
            "number",
            "reading",
            "refused",
            "require_ending",
        ),
        "text": (
            "TEXT_FORMATS",
            "parse_rows",
            "read_clouds",
        ),
        "written_clouds": ("write_cloud",),
    },
)
