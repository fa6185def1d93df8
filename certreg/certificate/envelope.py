"""The certificate: data, an integer quaternion, two dyadic numbers, and what follows from them.

File format `certreg-certificate/1`: JSON, UTF-8, sorted keys; every number that carries proof is an
integer or a dyadic pair [mantissa, exponent].
"""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from certreg.io import write_atomically

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator
    from fractions import Fraction

    from certreg.exact import Dyadic

FORMAT = "certreg-certificate/1"
ISOTROPIC = "isotropic"
PIECE = 3 << 18  # bytes of data encoded at a time: a multiple of three


@dataclass(frozen=True, slots=True, kw_only=True)
class Claims:
    """What the certificate claims; the checker proves each from the data or refuses.

    gap: the objective at the pose (over the best translation) exceeds the minimum by less.
    sin2_half_angle: sin^2(theta/2) is less, for the angle theta to every optimum; None: no claim.
    unique: True claims that the optimum is one single pose; False claims nothing.
    pattern: multiplicities of the eigenvalues of K, largest first.
    unstable: unstable eigenvalues of the dynamics at each component; None: no claim.
    basin: True claims that a body in the certificate's `basin` state ends at the optimum.
    sdp_gap: the gap as the dual of the semidefinite relaxation alone bounds it; None: no claim.
    """

    gap: Dyadic
    sin2_half_angle: Dyadic | None
    unique: bool
    pattern: tuple[int, ...]
    unstable: tuple[int, ...] | None
    basin: bool | None = None
    sdp_gap: Dyadic | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RotationState:
    """A rotation and an angular velocity (body frame, in the time unit of the springs), exactly.

    quaternion: integers (w, x, y, z). angular_velocity: three integers times 2^exponent.
    """

    quaternion: tuple[int, ...]
    angular_velocity: tuple[int, ...]
    exponent: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Certificate:
    """A proof object for one registration problem with isotropic springs.

    quaternion: integers (w, x, y, z), the certified rotation is R(q) of the unit vector along it.
    multiplier: nu with nu I - K > 0, the dual of the semidefinite relaxation rounded outwards.
    basin: a state of the moving body from which it must end at the optimum.
    mu, delta: (v + delta - mu) I - K + mu q q^T / |q|^2 > 0 with v = q^T K q / |q|^2.
    data: the bytes that are hashed into the digest; None where the problem is too large to inline.
    """

    n: int
    digest: str
    data: bytes | None
    quaternion: tuple[int, int, int, int]
    mu: Dyadic
    delta: Dyadic
    claims: Claims
    multiplier: Dyadic | None = None
    basin: RotationState | None = None
    about: dict[str, Any] = field(default_factory=dict[str, Any])

    @property
    def gap(self) -> Fraction:
        """The claimed bound on objective(R(q)) - minimum."""
        return self.claims.gap.value

    def pieces(self) -> Iterator[bytes]:
        """The file's content, piece by piece."""
        document = {
            "about": self.about,
            "basin": _state(self.basin),
            "claims": {
                "basin": self.claims.basin,
                "gap": _pair(self.claims.gap),
                "pattern": list(self.claims.pattern),
                "sdp_gap": _pair(self.claims.sdp_gap),
                "sin2_half_angle": _pair(self.claims.sin2_half_angle),
                "unique": self.claims.unique,
                "unstable": None if self.claims.unstable is None else list(self.claims.unstable),
            },
            "format": FORMAT,
            "kind": ISOTROPIC,
            "optimality": {"delta": _pair(self.delta), "mu": _pair(self.mu)},
            "pose": list(self.quaternion),
            "problem": {"data": None, "digest": self.digest, "n": self.n},
            "sdp": None if self.multiplier is None else {"nu": _pair(self.multiplier)},
        }
        yield from file_pieces(document, self.data)

    def to_json(self) -> bytes:
        """The file's content."""
        return b"".join(self.pieces())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file; under a temporary name first, so that it is never half there."""
        write_atomically(path, self.pieces())


def file_pieces(document: dict[str, Any], data: bytes | None) -> Iterator[bytes]:
    """A certificate's file, with the data in place of the null: large, so never twice in memory."""
    text = json.dumps(document, sort_keys=True, indent=1, allow_nan=False) + "\n"
    if data is None:
        yield text.encode()
        return
    # Within a string the quotes would be escaped, and of the parts `problem` is the last with data.
    before, name, after = text.rpartition('"data": ')
    yield (before + name + '"').encode()
    for start in range(0, len(data), PIECE):
        yield base64.b64encode(data[start : start + PIECE])
    yield ('"' + after.removeprefix("null")).encode()


def _state(state: RotationState | None) -> dict[str, list[int]] | None:
    if state is None:
        return None
    velocity = [*state.angular_velocity, state.exponent]
    return {"angular_velocity": velocity, "quaternion": list(state.quaternion)}


def _pair(number: Dyadic | None) -> list[int] | None:
    return None if number is None else [number.mantissa, number.exponent]
