"""Certified scales beside Umeyama's formulas in 60 digits.

    make rates NAME=scale_bounds ARGS="[COUNT [FIRST]]"

Problems FIRST, FIRST + 1, ...; each has its seed.

Random problems: scales 1e-2 to 1e2, sizes 1e-3 to 1e3, noise up to 300 %, some mirrored, planar or
weighted; a third with the symmetric scale, a fifth without a translation. Each is certified, and so
is the rigid one of the same points, whose rotation must be the same, bit by bit. The reference is
Umeyama's: centroids, C = U D V^T, R = U S V^T, s = tr(D S) / Sxx, or Horn's sqrt(Syy / Sxx), from
the doubles on in mpmath. At the end the checker alone, a process without any library, reads all
certificates.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from mpmath import diag, fdot, fsum, matrix, mp, mpf, sqrt, svd_r, workdps
from strategies import random_rotation

from certreg import RegistrationProblem, certify
from certreg.results import Optimality

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

PROBLEMS = 10_000
DIGITS = 60  # of the reference
ERROR = 1e-14  # of the scale to itself, of the rotation's entries, of the shift to the coordinates
WIDTH = 1e-20  # of the proved interval of the scale to itself
CHECKER = Path(__file__).resolve().parents[2] / "certreg" / "verify.py"
SLACK = mpf(10) ** -50  # of an end of the interval: that of the reference, and its rounding


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A pair of clouds, with its weights, and how it is to be solved."""

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    weights: NDArray[np.float64]
    scale: str
    rotation_only: bool

    def stated(self, scale: str) -> RegistrationProblem:
        """With this scale: its own, or none."""
        return RegistrationProblem(
            self.source,
            self.target,
            weights=self.weights,
            scale=scale,
            rotation_only=self.rotation_only,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """The optimum in 60 digits; coordinates: the largest that the translation is made of."""

    scale: Any
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    coordinates: float


@dataclass(slots=True)
class Tally:
    """The worst errors so far, and how many problems came out otherwise than they must."""

    scale: float = 0.0
    width: float = 0.0
    rotation: float = 0.0
    translation: float = 0.0
    uncertified: int = 0
    outside: int = 0
    unlike_rigid: int = 0
    refused: int = 0

    @property
    def good(self) -> bool:
        """Whether all are as they must be."""
        most = max(self.scale, self.rotation, self.translation)
        wrong = self.uncertified + self.outside + self.unlike_rigid + self.refused
        return not wrong and most <= ERROR and self.width <= WIDTH


def random_problem(seed: int) -> Problem:
    """One of the problems."""
    rng = np.random.default_rng([2121, seed])
    n, size = int(rng.integers(4, 40)), 10.0 ** rng.uniform(-3, 3)
    scale, noise = 10.0 ** rng.uniform(-2, 2), rng.choice([0.0, 1e-6, rng.uniform(0.0, 3.0)])
    x = size * rng.normal(size=(n, 3)) * rng.uniform(0.2, 1.0, 3)
    if seed % 7 == 0:
        x[:, 2] = 0.0
    y = scale * x @ random_rotation(rng).T
    if seed % 4 == 0:
        y = y * [1.0, 1.0, -1.0]
    y = y + noise * scale * size * rng.normal(size=(n, 3))
    rotation_only = seed % 5 == 0
    if not rotation_only:
        x, y = x + 3.0 * size * rng.normal(size=3), y + 10.0 * scale * size * rng.normal(size=3)
    weights = 10.0 ** rng.uniform(-2.0, 2.0, size=n) if seed % 2 else np.ones(n)
    return Problem(
        source=x,
        target=y,
        weights=weights,
        scale="symmetric" if seed % 3 == 0 else "asymmetric",
        rotation_only=rotation_only,
    )


def reference(problem: Problem) -> Reference:
    """Umeyama's or Horn's similarity of the doubles, by a singular value decomposition."""
    with workdps(DIGITS):
        w = [mpf(k) for k in problem.weights]
        mass, columns, means = fsum(w), [], []
        for column in (*problem.source.T, *problem.target.T):
            values = [mpf(k) for k in column]
            means.append(mpf(0) if problem.rotation_only else fdot(w, values) / mass)
            columns.append([v - means[-1] for v in values])
        x, y = columns[:3], columns[3:]
        loads = [[a * k for a, k in zip(w, column, strict=True)] for column in x]
        C = matrix([[fdot(a, b) for b in loads] for a in y])
        Sxx = fsum(fdot(a, b) for a, b in zip(loads, x, strict=True))
        Syy = fsum(fdot(w, [k * k for k in column]) for column in y)
        U, D, V = svd_r(C)  # C = U diag(D) V
        sign = diag([1, 1, 1 if mp.det(U) * mp.det(V) > 0 else -1])
        R, alignment = U * sign * V, fsum(sign[k, k] * D[k] for k in range(3))
        s = sqrt(Syy / Sxx) if problem.scale == "symmetric" else alignment / Sxx
        shifts = [means[3 + i] - s * fdot(R[i, :], means[:3]) for i in range(3)]
        most = max(*map(abs, means[3:]), *[s * abs(m) for m in means[:3]])
        return Reference(
            scale=s,
            rotation=np.array(R.tolist(), dtype=float),
            translation=np.array(shifts, dtype=float),
            coordinates=float(most),
        )


def counted(first: int, count: int) -> Tally:
    """Over so many problems; their certificates are written to a file, and checked together."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "all.jsonl")
        with path.open("wb") as lines:
            for seed in range(first, first + count):
                lines.write(certified(random_problem(seed), tally) + b"\n")
        tally.refused = count - accepted(path)
    return tally


def certified(problem: Problem, tally: Tally) -> bytes:
    """The certificate in a line, which is empty if there is none; errors go to the tally."""
    found, rigid = (
        certify(problem.stated(scale), relaxation=False, simulation=False)
        for scale in (problem.scale, "none")
    )
    tally.uncertified += {found.status, rigid.status} != {Optimality.CERTIFIED}
    tally.unlike_rigid += not np.array_equal(found.pose.rotation, rigid.pose.rotation)
    best = reference(problem)
    _compare(found.pose, best, tally)
    if found.certificate is None:
        return b""
    claims = found.certificate.body.claims
    compare_interval(claims.scale_lower.value, claims.scale_upper.value, best, tally)
    return found.certificate.to_json().replace(b"\n", b" ")


def _compare(pose: Any, best: Reference, tally: Tally) -> None:
    with workdps(DIGITS):
        tally.scale = max(tally.scale, abs(float(pose.scale / best.scale - 1)))
    tally.rotation = max(tally.rotation, float(np.abs(pose.rotation - best.rotation).max()))
    shift = float(np.abs(pose.translation - best.translation).max())
    tally.translation = max(tally.translation, shift / (best.coordinates or 1.0))


def compare_interval(low: Fraction, high: Fraction, best: Reference, tally: Tally) -> None:
    """Whether the reference is between, and how far apart these are."""
    tally.width = max(tally.width, float(high / low - 1))
    with workdps(DIGITS):
        below, above = (mpf(end.numerator) / end.denominator for end in (low, high))
        tally.outside += not below * (1 - SLACK) <= best.scale <= above * (1 + SLACK)


def accepted(path: Path) -> int:
    """How many certificates of a file the checker verifies, in a process of its own."""
    ask = [sys.executable, "-I", "-S", str(CHECKER), str(path)]
    said = subprocess.run(ask, capture_output=True, encoding="utf-8", check=False).stdout
    return int(said.splitlines()[-1].split(" of ")[0])


def main(count: int = PROBLEMS, first: int = 0) -> int:
    """Print the worst of each; 1 if one is not as it must be."""
    tally = counted(first, count)
    sys.stdout.write(
        f"{'' if tally.good else 'MISSED '}{count} problems with a free scale: "
        f"{tally.uncertified} not certified, {tally.refused} certificates refused, "
        f"{tally.unlike_rigid} with another rotation than the rigid problem. Beside Umeyama's and "
        f"Horn's formulas in {DIGITS} digits, the largest errors: scale {tally.scale:.1e} of "
        f"itself, entries of the rotation {tally.rotation:.1e}, translation "
        f"{tally.translation:.1e} of the largest coordinate; {tally.outside} outside the proved "
        f"interval, whose ends are at most {tally.width:.1e} of the scale apart\n"
    )
    return 0 if tally.good else 1


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:3])))
