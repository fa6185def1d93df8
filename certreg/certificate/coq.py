"""A certificate as a Coq file: its integers, copied, for the verified checker to decide.

Nothing is computed here but powers of two taken out of the doubles; `Checker.v` recomputes the
rest, and its theorem `checker_sound` says what an accepted file proves. The form of the file, its
digest and the finiteness of its numbers are checked while reading, by the code of `certreg.verify`.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError
from certreg.settings import CoqSettings
from certreg.verify import Isotropic, RefusalError, bound_doubles, parse, require

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from fractions import Fraction

    from certreg.verify import Clouds

HEADER = """\
(* Exported by certreg: integers copied from a certificate; Coq decides what they prove.
   SHA-256 of the doubles of its points: {digest}
   coqc -R DERIVATIONS/coq Certreg FILE *)
From Coq Require Import ZArith List.
From Certreg Require Import Integers Checker.
Import ListNotations.
Open Scope Z_scope.
"""
DECISION = """
Definition refused{tag} := Eval vm_compute in reasons data{tag} statement{tag}.
Print refused{tag}.
"""
THEOREM = """
Theorem certified : proved data statement.
Proof. apply checker_sound. vm_cast_no_check (eq_refl true). Qed.
(* What it assumes is what checker_sound does: Print Assumptions certified. *)
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CoqProblem:
    """A well-formed certificate in Coq's words: definitions of `data` and `statement`."""

    n: int
    digest: str
    definitions: str

    def theorem(self) -> str:
        """A file with the theorem that all claims are true; Coq rejects it where they are not."""
        return self._file() + THEOREM

    def refusal(self) -> str:
        """A file that prints the reasons to refuse the certificate, none if it is accepted."""
        return self._file() + DECISION.format(tag="")

    def decision(self, tag: str) -> str:
        """The same without its head, under names that end in the tag: for many in one file."""
        return self.definitions.replace("@", tag) + DECISION.format(tag=tag)

    def _file(self) -> str:
        return HEADER.format(digest=self.digest) + self.definitions.replace("@", "")


def export(
    certificate: bytes, clouds: Clouds | None = None, *, settings: CoqSettings | None = None
) -> CoqProblem:
    """The certificate for Coq, of kind isotropic; InvalidFileError for another.

    Raises RefusalError where it is malformed or of other points.
    """
    stated = parse(certificate)
    if not isinstance(stated, Isotropic):
        what = f"a certificate of kind {stated.kind}, and Coq decides on kind isotropic alone"
        raise InvalidFileError(
            f"{what}: leave out --coq", column="kind", value=stated.kind, limit="isotropic"
        )
    content, n = bytes(bound_doubles(stated, clouds)), stated.n
    numbers = struct.unpack(f"<{7 * n}d", content)
    require(all(map(isfinite, numbers)), "the data hold a number that is not finite")
    minus_zero = struct.pack("<d", -0.0)
    whole = minus_zero not in content or all(struct.pack("<d", x) != minus_zero for x in numbers)
    require(whole, "the data hold -0.0, which is not canonical")
    length = (settings or CoqSettings()).points_in_a_list
    definitions = _data(numbers, n, length) + _statement(stated)
    return CoqProblem(n=n, digest=stated.digest, definitions=definitions)


def _data(numbers: Sequence[float], n: int, length: int) -> str:
    x, ex = _integers(numbers[: 3 * n])
    y, ey = _integers(numbers[3 * n : 6 * n])
    w, ew = _integers(numbers[6 * n :])
    rows = [
        " ".join(map(_integer, (w[i], *x[3 * i : 3 * i + 3], *y[3 * i : 3 * i + 3])))
        for i in range(n)
    ]
    parts = [rows[start : start + length] for start in range(0, n, length)]
    lists = [
        f"Definition points{k}@ := [\n  " + ";\n  ".join(f"ZPair {row}" for row in part) + "].\n"
        for k, part in enumerate(parts)
    ]
    joined = " ++ ".join(f"points{k}@" for k in range(len(parts)))
    powers = " ".join(map(_integer, (ew, ex, ey)))
    return "\n" + "".join(lists) + f"Definition data@ := Data ({joined}) {powers}.\n"


def _integers(numbers: Sequence[float]) -> tuple[list[int], int]:
    """Integers k and the one exponent e such that the numbers are k 2^e exactly."""
    ratios = [number.as_integer_ratio() for number in numbers]
    shift = max(below.bit_length() - 1 for _, below in ratios)
    lifted = [above << (shift + 1 - below.bit_length()) for above, below in ratios]
    common = 0
    for k in lifted:
        common |= k
    spare = (common & -common).bit_length() - 1 if common else 0
    return [k >> spare for k in lifted], spare - shift


def _statement(stated: Isotropic) -> str:
    pose, turned = (_record("ZQuat", each) for each in (stated.pose, stated.quaternion))
    spinning = "None"
    if stated.angular_velocity is not None:
        *velocity, exponent = stated.angular_velocity
        spinning = f"(Some ({_record('ZVec', velocity)}, {_integer(exponent)}))"
    entries = {
        "pose": pose,
        "delta": _dyadic(stated.delta),
        "mu": _dyadic(stated.mu),
        "gap": _dyadic(stated.gap),
        "sin2": _optional_dyadic(stated.sin2_half_angle),
        "unique": _truth(stated.unique),
        "multiplicities": _list(stated.pattern),
        "unstable": "None" if stated.unstable is None else f"Some {_list(stated.unstable)}",
        "nu": _optional_dyadic(stated.nu),
        "sdp_gap": _optional_dyadic(stated.sdp_gap),
        "basin": _truth(stated.basin),
        "turned": "None" if stated.quaternion is None else f"Some {turned}",
        "spinning": spinning,
    }
    words = ";\n  ".join(f"{name} := {value}" for name, value in entries.items())
    return f"Definition statement@ := {{|\n  {words} |}}.\n"


def _integer(number: int) -> str:
    return f"{number:#x}" if number >= 0 else f"({number:#x})"  # decimal takes Coq longer


def _record(name: str, numbers: Iterable[int] | None) -> str:
    return "None" if numbers is None else f"({name} {' '.join(map(_integer, numbers))})"


def _list(numbers: Iterable[int]) -> str:
    return f"[{'; '.join(map(_integer, numbers))}]"


def _truth(value: object) -> str:
    return "true" if value else "false"


def _dyadic(value: Fraction) -> str:
    """A rational whose denominator is a power of two, with an odd mantissa."""
    if value.denominator.bit_count() != 1:
        raise RefusalError("a number is not dyadic")
    low = (value.numerator & -value.numerator).bit_length() - 1 if value else 0
    exponent = low - (value.denominator.bit_length() - 1)
    return f"(Dyadic {_integer(value.numerator >> low)} {_integer(exponent)})"


def _optional_dyadic(value: Fraction | None) -> str:
    return "None" if value is None else f"(Some {_dyadic(value)})"
