"""Certificates of kind "similarity": the optimal pose of a problem whose scale is free.

The rotation is proved as in the kind "isotropic"; its theorems, and how they give the scale, are in
`certreg.verify`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from certreg.certificate.isotropic import RotationBody, RotationClaims
from certreg.exact.dyadic import Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityClaims(RotationClaims):
    """What is claimed besides. scale_lower, scale_upper: the scale of every optimum is between."""

    scale_lower: Dyadic
    scale_upper: Dyadic


@dataclass(frozen=True, slots=True, kw_only=True)
class SimilarityBody(RotationBody):
    """A proof that a pose with a scale is optimal, and between which scales.

    scale: "asymmetric" or "symmetric", as of the problem.
    """

    KIND: ClassVar[str] = "similarity"

    scale: str
    claims: SimilarityClaims
