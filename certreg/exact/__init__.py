"""Integer and ball arithmetic that decides."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.exact.balls import exact_matrix as exact_matrix
    from certreg.exact.balls import fixed_point as fixed_point
    from certreg.exact.balls import morse_bott_index as morse_bott_index
    from certreg.exact.balls import negative_eigenvalues as negative_eigenvalues
    from certreg.exact.balls import orthonormal as orthonormal
    from certreg.exact.balls import radius_bits as radius_bits
    from certreg.exact.decimals import as_given as as_given
    from certreg.exact.decimals import at_least as at_least
    from certreg.exact.decimals import at_most as at_most
    from certreg.exact.dyadic import ASIN_SLACK as ASIN_SLACK
    from certreg.exact.dyadic import PI_ABOVE as PI_ABOVE
    from certreg.exact.dyadic import STEEP as STEEP
    from certreg.exact.dyadic import Dyadic as Dyadic
    from certreg.exact.dyadic import degrees_above as degrees_above
    from certreg.exact.dyadic import double_above as double_above
    from certreg.exact.dyadic import double_below as double_below
    from certreg.exact.dyadic import dyadic_above as dyadic_above
    from certreg.exact.dyadic import dyadic_below as dyadic_below
    from certreg.exact.dyadic import dyadic_root_above as dyadic_root_above
    from certreg.exact.dyadic import half_angle_bound as half_angle_bound
    from certreg.exact.dyadic import in_one_unit as in_one_unit
    from certreg.exact.dyadic import nearest_double as nearest_double
    from certreg.exact.dyadic import nearest_or_zero as nearest_or_zero
    from certreg.exact.dyadic import nearest_quotient as nearest_quotient
    from certreg.exact.dyadic import nearest_root as nearest_root
    from certreg.exact.dyadic import power_of_two as power_of_two
    from certreg.exact.dyadic import quotient_or_zero as quotient_or_zero
    from certreg.exact.dyadic import rational_root_above as rational_root_above
    from certreg.exact.dyadic import root_above as root_above
    from certreg.exact.dyadic import root_of_quotient as root_of_quotient
    from certreg.exact.dyadic import sigma_of_weight as sigma_of_weight
    from certreg.exact.dyadic import weight_of_sigma as weight_of_sigma
    from certreg.exact.eigenbasis import Eigenbasis as Eigenbasis
    from certreg.exact.eigenbasis import integer_eigenbasis as integer_eigenbasis
    from certreg.exact.elimination import definite_inverse as definite_inverse
    from certreg.exact.elimination import is_positive_definite as is_positive_definite
    from certreg.exact.elimination import nullspace as nullspace
    from certreg.exact.elimination import rank as rank
    from certreg.exact.signs import RootSigns as RootSigns
    from certreg.exact.signs import signs_of_eigenvalues as signs_of_eigenvalues
    from certreg.exact.signs import signs_of_roots as signs_of_roots
    from certreg.exact.spaces import IntegerQuaternion as IntegerQuaternion
    from certreg.exact.spaces import Resolution as Resolution
    from certreg.exact.spaces import Space as Space
    from certreg.exact.spaces import resolved as resolved

__getattr__ = lazy_face(
    __name__,
    {
        "balls": (
            "exact_matrix",
            "fixed_point",
            "morse_bott_index",
            "negative_eigenvalues",
            "orthonormal",
            "radius_bits",
        ),
        "decimals": (
            "as_given",
            "at_least",
            "at_most",
        ),
        "dyadic": (
            "ASIN_SLACK",
            "PI_ABOVE",
            "STEEP",
            "Dyadic",
            "degrees_above",
            "double_above",
            "double_below",
            "dyadic_above",
            "dyadic_below",
            "dyadic_root_above",
            "half_angle_bound",
            "in_one_unit",
            "nearest_double",
            "nearest_or_zero",
            "nearest_quotient",
            "nearest_root",
            "power_of_two",
            "quotient_or_zero",
            "rational_root_above",
            "root_above",
            "root_of_quotient",
            "sigma_of_weight",
            "weight_of_sigma",
        ),
        "eigenbasis": (
            "Eigenbasis",
            "integer_eigenbasis",
        ),
        "elimination": (
            "definite_inverse",
            "is_positive_definite",
            "nullspace",
            "rank",
        ),
        "signs": (
            "RootSigns",
            "signs_of_eigenvalues",
            "signs_of_roots",
        ),
        "spaces": (
            "IntegerQuaternion",
            "Resolution",
            "Space",
            "resolved",
        ),
    },
)
