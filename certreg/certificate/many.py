"""Certificates of many problems: proved in compiled code where its integers are wide enough.

There the claims of a certificate are proved by the inequalities that stand in native/certifying.c,
in integers of a fixed width, before they are made. Where these do not prove them, and where nothing
is compiled, `produce` makes the certificate and the checker accepts it, problem by problem.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from operator import index
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.envelope import Certificate
from certreg.certificate.isotropic import Claims, IsotropicBody, produce
from certreg.equilibrium.equilibrium_set import rotation_double
from certreg.exact.dyadic import (
    ASIN_SLACK,
    PI_ABOVE,
    STEEP,
    Dyadic,
    double_above,
    half_angle_bound,
    nearest_or_zero,
)
from certreg.io.atomic import write_atomically
from certreg.native.library import ProvedOptima, library_if_any
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.problem.many import ManyPairs

PORTION = 256  # problems that one call into C takes: Ctrl-C is answered within milliseconds
PATTERN = (1, 1, 1, 1)  # what compiled code proves: four equilibria, so that three points are
UNSTABLE = (0, 1, 2, 3)  # not collinear
UNPROVED = b"null\n"  # a line that the checker refuses


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Certificates(Brief):
    """Certificates of many problems, in their order; `certificates[k]` is one of them.

    Attributes
    ----------
    poses
        (count, 4, 4), the certified rotations with their best translations, in doubles: far from
        the origin a translation is off by the rounding of what is subtracted, some 1e-15 of the
        coordinates. Infinite where a translation is beyond doubles.
    gaps
        (count,), proved: the objective at the certified rotation, best translation, exceeds the
        minimum by less. Infinite where nothing is proved.
    angles
        (count,), proved: the optimum is nearer to the certified rotation, in radians. NaN where
        there are several, or nothing is proved.
    unique
        (count,), proved: there is one optimum.
    """

    poses: NDArray[np.float64]
    gaps: NDArray[np.float64]
    angles: NDArray[np.float64]
    unique: NDArray[np.bool_]
    _pairs: ManyPairs
    _optima: ProvedOptima
    _others: dict[int, Certificate[IsotropicBody] | None]  # not proved in compiled code

    def __repr__(self) -> str:
        return f"<Certificates of {len(self)} problems, {int(self.unique.sum())} of one optimum>"

    def __len__(self) -> int:
        return len(self.gaps)

    def __getitem__(self, number: int) -> Certificate[IsotropicBody] | None:
        """The certificate of one problem; None where nothing is proved of it."""
        number = range(len(self))[index(number)]
        if number in self._others:
            return self._others[number]
        optima = self._optima
        w, x, y, z = optima.quaternions[number].tolist()
        mu, delta, sine = (
            Dyadic.of_pair(pairs[number].tolist())
            for pairs in (optima.mu, optima.delta, optima.sine)
        )
        claims = Claims(
            gap=delta.shifted(1),
            sin2_half_angle=sine,
            unique=True,
            pattern=PATTERN,
            unstable=UNSTABLE,
        )
        body = IsotropicBody(quaternion=(w, x, y, z), mu=mu, delta=delta, claims=claims)
        data = self._pairs.data_bytes(number)
        return Certificate(
            n=int(self._pairs.sizes[number]),
            digest=hashlib.sha256(data).hexdigest(),
            inline=data,
            body=body,
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a file `.jsonl`, a certificate a line: `verify.py PATH` checks it.

        A problem of which nothing is proved has the line `null`, which is refused. The file is
        never half there: it has another name until it is whole.

        Parameters
        ----------
        path
            Of the file.

        Raises
        ------
        InvalidFileError
            Where it cannot be written.
        """
        write_atomically(path, self.lines())

    def lines(self) -> Iterator[bytes]:
        """What `save` writes, line by line."""
        for number in range(len(self)):
            one = self[number]
            yield UNPROVED if one is None else one.line()


def certificates_of(
    pairs: ManyPairs, progress: Callable[[int, int], object] | None = None
) -> Certificates:
    """The certificates of many problems.

    progress: called with the number of problems that are done and that of all.
    """
    count = len(pairs)
    optima, others = ProvedOptima.none(count), dict[int, Certificate[IsotropicBody] | None]()
    for first in range(0, count, PORTION):
        chosen = slice(first, min(first + PORTION, count))
        _prove(pairs, chosen, optima)
        for number in (first + np.flatnonzero(~optima.proved[chosen])).tolist():
            others[number], optima.poses[number] = _alone(pairs, number)
        if progress is not None:
            progress(chosen.stop, count)
    claims = {k: None if one is None else one.body.claims for k, one in others.items()}
    gaps, angles = _gaps(optima), _angles(optima)
    unique = optima.proved.copy()
    for number, claim in claims.items():
        gaps[number] = np.inf if claim is None else double_above(claim.gap.value)
        sine = None if claim is None else claim.sin2_half_angle
        angles[number] = np.nan if sine is None else half_angle_bound(sine.value)
        unique[number] = claim is not None and claim.unique
    return Certificates(
        poses=optima.poses,
        gaps=gaps,
        angles=angles,
        unique=unique,
        _pairs=pairs,
        _optima=optima,
        _others=others,
    )


def _prove(pairs: ManyPairs, chosen: slice, optima: ProvedOptima) -> None:
    """Write what compiled code proves of some problems."""
    library = library_if_any()
    if library is not None:
        clouds = (pairs.source, pairs.target, pairs.weights)
        found = library.prove_optima(clouds, pairs.sizes[chosen], pairs.starts[chosen])
        for each in fields(optima):
            getattr(optima, each.name)[chosen] = getattr(found, each.name)


def _alone(
    pairs: ManyPairs, number: int
) -> tuple[Certificate[IsotropicBody] | None, NDArray[np.float64]]:
    """The certificate of one problem as `certify` makes it, accepted by the checker; its pose."""
    source, target, weights = pairs.of_one(number)
    problem = RegistrationProblem(source, target, weights=weights)
    objective = Isotropic(exact_moments(problem))
    certificate = produce(problem, objective)
    if certificate is not None:
        require_accepted(check_own(certificate, problem))
    q, pose = objective.optimum, np.eye(4)
    pose[:3, :3] = rotation_double(q)
    pose[:3, 3] = [nearest_or_zero(entry) for entry in objective.best_translation(q)]
    return certificate, pose


def _gaps(optima: ProvedOptima) -> Any:
    """2 delta, as doubles that are not below."""
    with np.errstate(over="ignore", under="ignore"):
        gaps = _doubles(optima.delta + np.array([0, 1]))
        above: Any = np.nextafter(gaps, np.inf)
    return np.where(gaps < np.finfo(float).tiny, above, gaps)


def _angles(optima: ProvedOptima) -> Any:
    """As `half_angle_bound`."""
    sines = np.minimum(1.0, _doubles(optima.sine))  # of 32 bits: no difference is rounded
    low = 2.0 * np.arcsin(np.sqrt(sines)) * ASIN_SLACK
    high = PI_ABOVE - 2.0 * np.arcsin(np.sqrt(1.0 - sines)) / ASIN_SLACK
    return np.minimum(np.pi, np.where(sines > STEEP, high, low))


def _doubles(dyadic: NDArray[np.int64]) -> NDArray[np.float64]:
    """Mantissas times two to the exponents: of 32 bits, for `ldexp` on Windows."""
    return np.ldexp(dyadic[:, 0].astype(float), dyadic[:, 1].astype(np.int32))
