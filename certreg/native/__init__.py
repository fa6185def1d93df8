"""The generated code at work: compiled with the package, or run in Python; trajectory loops.

No formula of the dynamics stands here: those are in certreg/native/generated. Handwritten are the
loops around a step, the stop test, and the escape from a saddle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.native.bit_rows import BitRows as BitRows
    from certreg.native.bit_rows import Neighbours as Neighbours
    from certreg.native.bit_rows import agreeing as agreeing
    from certreg.native.bit_rows import colours as colours
    from certreg.native.bit_rows import mask_of as mask_of
    from certreg.native.bit_rows import rows_of as rows_of
    from certreg.native.bit_rows import thinned as thinned
    from certreg.native.cliques import enumeration as enumeration
    from certreg.native.cliques import greedy_clique as greedy_clique
    from certreg.native.cliques import triangles as triangles
    from certreg.native.codegen.emit import C_FILE as C_FILE
    from certreg.native.codegen.emit import HEADER_FILE as HEADER_FILE
    from certreg.native.codegen.emit import generated_files as generated_files
    from certreg.native.cones import ConeSearch as ConeSearch
    from certreg.native.cones import ConesEnding as ConesEnding
    from certreg.native.cones import search_cones as search_cones
    from certreg.native.eigenbasis import FIXED_BITS as FIXED_BITS
    from certreg.native.eigenbasis import fixed_eigenbasis as fixed_eigenbasis
    from certreg.native.engine import compiled_engine as compiled_engine
    from certreg.native.engine import current_engine as current_engine
    from certreg.native.kernels import GENERATED as GENERATED
    from certreg.native.kernels import HERE as HERE
    from certreg.native.kernels import MissingLibraryError as MissingLibraryError
    from certreg.native.kernels import VariantError as VariantError
    from certreg.native.lawson import LawsonColumns as LawsonColumns
    from certreg.native.lawson import lawson_columns as lawson_columns
    from certreg.native.layout import BASIN as BASIN
    from certreg.native.layout import BODY as BODY
    from certreg.native.layout import BREATHING_ENERGIES as BREATHING_ENERGIES
    from certreg.native.layout import BREATHING_SAMPLE as BREATHING_SAMPLE
    from certreg.native.layout import BREATHING_STATE as BREATHING_STATE
    from certreg.native.layout import ENERGIES as ENERGIES
    from certreg.native.layout import EXACT_SUMS as EXACT_SUMS
    from certreg.native.layout import MATRIX_STATE as MATRIX_STATE
    from certreg.native.layout import MEANS as MEANS
    from certreg.native.layout import QUATERNION_STATE as QUATERNION_STATE
    from certreg.native.layout import SPRING_BODY as SPRING_BODY
    from certreg.native.layout import SPRING_ENERGIES as SPRING_ENERGIES
    from certreg.native.layout import SPRING_SAMPLE as SPRING_SAMPLE
    from certreg.native.layout import SUMS as SUMS
    from certreg.native.layout import Records as Records
    from certreg.native.layout import RecordType as RecordType
    from certreg.native.layout import named as named
    from certreg.native.layout import plain as plain
    from certreg.native.layout import record_of as record_of
    from certreg.native.layout import symmetric as symmetric
    from certreg.native.layout import width as width
    from certreg.native.library import Library as Library
    from certreg.native.library import library_if_any as library_if_any
    from certreg.native.library import loaded_library as loaded_library
    from certreg.native.loops import BASIN_SHARE as BASIN_SHARE
    from certreg.native.loops import LARGEST_PERTURBATION as LARGEST_PERTURBATION
    from certreg.native.loops import PERTURBATION_GROWTH as PERTURBATION_GROWTH
    from certreg.native.loops import Batch as Batch
    from certreg.native.loops import Ending as Ending
    from certreg.native.loops import Engine as Engine
    from certreg.native.loops import Integrator as Integrator
    from certreg.native.loops import Kind as Kind
    from certreg.native.loops import Log as Log
    from certreg.native.loops import Rules as Rules
    from certreg.native.optima import ProvedOptima as ProvedOptima
    from certreg.native.paths import REACHED as REACHED
    from certreg.native.paths import STUCK as STUCK
    from certreg.native.paths import NearbyPoint as NearbyPoint
    from certreg.native.paths import PathEnds as PathEnds
    from certreg.native.paths import PathRules as PathRules
    from certreg.native.paths import critical_point_near as critical_point_near
    from certreg.native.paths import many_quartic_paths as many_quartic_paths
    from certreg.native.paths import quartic_paths as quartic_paths
    from certreg.native.stationary import ManyClouds as ManyClouds
    from certreg.native.stationary import StationaryPoses as StationaryPoses
    from certreg.native.sums import IntegerSums as IntegerSums
    from certreg.native.sums import fixed_point_fits as fixed_point_fits
    from certreg.native.sums import springs_by_exponent as springs_by_exponent
    from certreg.native.sums import springs_by_limbs as springs_by_limbs
    from certreg.native.sums import sums_by_exponent as sums_by_exponent
    from certreg.native.sums import sums_in_fixed_point as sums_in_fixed_point

__getattr__ = lazy_face(
    __name__,
    {
        "bit_rows": (
            "BitRows",
            "Neighbours",
            "agreeing",
            "colours",
            "mask_of",
            "rows_of",
            "thinned",
        ),
        "cliques": (
            "enumeration",
            "greedy_clique",
            "triangles",
        ),
        "codegen.emit": (
            "C_FILE",
            "HEADER_FILE",
            "generated_files",
        ),
        "cones": (
            "ConeSearch",
            "ConesEnding",
            "search_cones",
        ),
        "eigenbasis": (
            "FIXED_BITS",
            "fixed_eigenbasis",
        ),
        "engine": (
            "compiled_engine",
            "current_engine",
        ),
        "kernels": (
            "GENERATED",
            "HERE",
            "MissingLibraryError",
            "VariantError",
        ),
        "lawson": (
            "LawsonColumns",
            "lawson_columns",
        ),
        "layout": (
            "BASIN",
            "BODY",
            "BREATHING_ENERGIES",
            "BREATHING_SAMPLE",
            "BREATHING_STATE",
            "ENERGIES",
            "EXACT_SUMS",
            "MATRIX_STATE",
            "MEANS",
            "QUATERNION_STATE",
            "RecordType",
            "Records",
            "SPRING_BODY",
            "SPRING_ENERGIES",
            "SPRING_SAMPLE",
            "SUMS",
            "named",
            "plain",
            "record_of",
            "symmetric",
            "width",
        ),
        "library": (
            "Library",
            "library_if_any",
            "loaded_library",
        ),
        "loops": (
            "BASIN_SHARE",
            "Batch",
            "Ending",
            "Engine",
            "Integrator",
            "Kind",
            "LARGEST_PERTURBATION",
            "Log",
            "PERTURBATION_GROWTH",
            "Rules",
        ),
        "optima": ("ProvedOptima",),
        "paths": (
            "REACHED",
            "STUCK",
            "NearbyPoint",
            "PathEnds",
            "PathRules",
            "critical_point_near",
            "many_quartic_paths",
            "quartic_paths",
        ),
        "stationary": (
            "ManyClouds",
            "StationaryPoses",
        ),
        "sums": (
            "IntegerSums",
            "fixed_point_fits",
            "springs_by_exponent",
            "springs_by_limbs",
            "sums_by_exponent",
            "sums_in_fixed_point",
        ),
    },
)
