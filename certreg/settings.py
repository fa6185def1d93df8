"""Every number that is a choice, with its reason. Nothing here can weaken a proof."""

from __future__ import annotations

import math
from dataclasses import dataclass

DEFAULT_DAMPING = math.sqrt(8.0)  # critical damping of every mode of noise-free data: 2 sqrt(2)


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectrumSettings:
    """Working precision of the eigenbasis, in bits."""

    start_bits: int = 192  # two sweeps from doubles; a second pass for relative gaps below 2^-32
    pose_bits: int = 96  # proved angle about 2^-94 where the gap is of the order of the spectrum
    guard_bits: int = 32  # more than the rounding of all the rotations of a run
    max_bits: int = 16384  # the checker takes no longer integers


@dataclass(frozen=True, slots=True, kw_only=True)
class CertificateSettings:
    """Sizes within a certificate."""

    inline_points: int = 1_000_000  # the contract: beyond, the file carries the digest only
    bound_bits: int = 32  # mantissa of mu and delta: short numbers, at most 2^-31 wasted
    growth_bits: int = 16  # delta grows by 2^16 after a refused attempt
    attempts: int = 8  # 8 * 16 bits: far beyond any rounding of the first guess


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessmentSettings:
    """Where the words of an assessment change. Gaps are relative to the spread of both clouds."""

    rotation_tolerance: float = 1e-4  # |R^T R - I|: admits 4x4 matrices printed with five decimals
    optimal_gap: float = 1e-12  # a pose off by one part in a million
    near_optimal_gap: float = 1e-4  # a pose off by one part in a hundred
    equilibrium_angle: float = 1e-3  # radians: a pose printed with few digits still counts
    equilibrium_shift: float = 1e-3  # distance of the centroids, relative to the clouds' radius


@dataclass(frozen=True, slots=True, kw_only=True)
class AgreementSettings:
    """When a floating-point road contradicts the certificate."""

    relative_gap: float = 1e-11  # of the spread: a thousand times the rounding of an O(N) sum


@dataclass(frozen=True, slots=True, kw_only=True)
class FileSettings:
    """Bounds on what is read."""

    max_text_bytes: int = 1 << 30  # ten million points
    max_line_bytes: int = 1 << 16  # a row of a cloud with many extra columns
    max_pose_bytes: int = 1 << 20  # a result without its points is a few kilobytes
