"""The report of a certificate in a folder: what is proved is proved anew, what is slow is reused.

The certificate is checked, and the registration computed again from the points in it: nothing shown
as exact rests on another file. Of the pose no more is said to be proved than the certificate given
proves, be it less than certreg would prove. Only the roads that take long are taken from
`result.json` and `trajectory.npz` beside it, where the digest says that they belong to it.
"""

from __future__ import annotations

import contextlib
import json
import math
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from certreg.certificate import (
    Certificate,
    ExactPose,
    IsotropicBody,
    PoseBounds,
    pose_bounds,
    verify,
)
from certreg.dynamics import body_of, read_record, start_at_rest
from certreg.errors import DegenerateProblemError, InvalidFileError, RefusedCertificateError
from certreg.geometry import quaternion_from_matrix
from certreg.io import MAX_POSE_BYTES, reading
from certreg.native import MATRIX_STATE, named
from certreg.problem import (
    DEFAULT_DAMPING,
    MAX_DAMPING,
    MIN_DAMPING,
    RegistrationProblem,
    exact_moments,
    lift,
)
from certreg.registration import certify
from certreg.report.document import RESULT_SCHEMA
from certreg.report.folder import RESULT, TRAJECTORY
from certreg.report.page import Report
from certreg.report.words import MethodAngles
from certreg.verify import FILE_MAX, Isotropic, RefusalError, bound_doubles, parse, shown

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from certreg.dynamics import Record
    from certreg.problem import ExactMoments
    from certreg.registration import Registration

Found = TypeVar("Found")
NOT_USED = "is broken, or does not belong to the certificate: computed anew"
WEAKER = 1e3  # times the bounds that certreg proves: the page warns of such a certificate
ENERGY_SHARE = 1e-9  # by which a logged energy may differ from that of its state
HALF_TURN = 180.0  # degrees: no angle between rotations is larger


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """What a result says of roads that take long; angles in degrees, None where not taken."""

    damping: float
    relaxation: float | None
    simulation: float | None


def report_of(
    certificate: str | os.PathLike[str], noted: Callable[[str], None] | None = None
) -> Report:
    """The report of a certificate of optimality that holds its points.

    noted: called with a sentence on each file beside the certificate that could not be used.
    Raises InvalidFileError for other files, RefusedCertificateError where the checker refuses.
    """
    file = Path(certificate)
    with reading(file) as stream:
        content = stream.read(FILE_MAX + 1)
    _require_points(content, file)
    verdict = verify(content)
    if not verdict.proved:
        message = f"{shown(file)}: REFUSED: {verdict.words}: there is nothing to report"
        raise RefusedCertificateError(message, verdict=verdict)
    stated = cast("Isotropic", parse(content))
    known = _beside(file.with_name(RESULT), lambda beside: _known(beside, stated.digest), noted)
    problem = _problem(stated, DEFAULT_DAMPING if known is None else known.damping)
    logged = None
    if known is not None:
        logged = _beside(file.with_name(TRAJECTORY), lambda beside: _logged(beside, problem), noted)
    registration = certify(
        problem,
        relaxation=known is None,
        simulation=known is None or (logged is None and known.simulation is not None),
    )
    angles = MethodAngles.of(registration.solution.agreement)
    if known is not None:
        angles = replace(angles, relaxation=known.relaxation)
    if logged is not None:
        angles = replace(angles, simulation=_end(registration, logged))
    body = Certificate.load(content).body
    if not isinstance(body, IsotropicBody):
        raise TypeError(body)
    given = _bounds(body, registration)
    return Report(
        registration=replace(registration, bounds=given, verdict=verdict),
        certificate=content,
        verdict=verdict,
        name=file.name,
        weak=_weaker(given, registration.bounds),
        logged=logged or registration.solution.trajectory,
        angles=angles,
    )


def _bounds(body: IsotropicBody, registration: Registration) -> PoseBounds:
    """What the certificate given proves of the pose that was computed anew."""
    pose = registration.pose
    place = ExactPose.of_doubles(pose.quaternion_wxyz, pose.translation)
    return pose_bounds(registration.solution.moments, body, place)


def _weaker(given: PoseBounds, proved: PoseBounds | None) -> bool:
    """Whether a certificate proves far less of a pose than certreg does."""
    if proved is None:
        return False
    if given.greatest_gap > Fraction(WEAKER) * proved.greatest_gap:
        return True
    if proved.angle_upper is None:
        return False
    return given.angle_upper is None or given.angle_upper > WEAKER * proved.angle_upper


def _require_points(content: bytes, file: Path) -> None:
    """InvalidFileError for a certificate of which no report can be made, sound as it may be."""
    try:
        stated = parse(content)
    except (RefusalError, MemoryError):
        return  # the checker says why
    if not isinstance(stated, Isotropic):
        what = f"is a certificate of kind {stated.kind}, which holds no pose"
        message = f"{shown(file)}: {what}: give the certificate.json that certify wrote"
        raise InvalidFileError(message)
    if stated.data is None:
        message = f"{shown(file)}: holds no points: certify --out writes the report of so many"
        raise InvalidFileError(message)


def _problem(stated: Isotropic, damping: float) -> RegistrationProblem:
    n = stated.n
    doubles = np.frombuffer(bound_doubles(stated, None), dtype="<f8")
    source, target, weights = np.split(doubles, [3 * n, 6 * n])
    return RegistrationProblem(
        source.reshape(n, 3), target.reshape(n, 3), weights=weights, damping=damping
    )


def _beside(
    file: Path, read: Callable[[Path], Found], noted: Callable[[str], None] | None
) -> Found | None:
    """What a file beside the certificate holds; None, with a note, if it is not to be used."""
    if not file.exists():
        return None
    with contextlib.suppress(InvalidFileError):
        if file.is_file():  # to open a pipe would wait for whoever writes to it
            return read(file)
    if noted is not None:
        noted(f"{shown(file)}: {NOT_USED}")
    return None


def _known(file: Path, digest: str) -> Known:
    """What a result of this problem says. Raises InvalidFileError if it is not sound."""
    with reading(file) as stream:
        text = stream.read(MAX_POSE_BYTES + 1)
    try:
        document: Any = json.loads(text)
        mine = (document["schema"], document["digest"]) == (RESULT_SCHEMA, digest)
        agreement = document["agreement"]
        known = Known(
            damping=document["damping"],
            relaxation=agreement["relaxation_deg"],
            simulation=agreement["simulation_deg"],
        )
    except (ValueError, RecursionError, KeyError, TypeError) as error:
        raise InvalidFileError(f"{shown(file)}: {NOT_USED}") from error
    angles = [angle for angle in (known.relaxation, known.simulation) if angle is not None]
    damped = _within(known.damping, MIN_DAMPING, MAX_DAMPING)
    if not (mine and damped and all(_within(angle, 0.0, HALF_TURN) for angle in angles)):
        raise InvalidFileError(f"{shown(file)}: {NOT_USED}")
    return known


def _within(value: object, least: float, most: float) -> bool:
    return isinstance(value, float) and least <= value <= most


def _logged(file: Path, problem: RegistrationProblem) -> Record:
    """The trajectory of this problem under this damping. Raises InvalidFileError for others."""
    record = read_record(file)
    mine = (record.digest, record.damping) == (problem.digest(), problem.damping)
    if not (mine and _simulated(record, exact_moments(problem))):
        raise InvalidFileError(f"{shown(file)}: {NOT_USED}")
    return record


def _simulated(record: Record, moments: ExactMoments) -> bool:
    """Whether a motion begins where the source was given, with the energies of its states."""
    try:
        moving = body_of(moments, record.damping)
    except DegenerateProblemError:
        return False
    if record.length_exponent != moving.length_exponent:
        return False
    start = start_at_rest(moments, moving.length_exponent)
    energies = [moving.energies(state) for state in record.states]
    pairs = (
        (record.states[0], start),
        (record.potential, np.array([energy.potential for energy in energies])),
        (record.kinetic, np.array([energy.kinetic for energy in energies])),
    )
    least = max(1.0, moving.spread)
    return all(bool((abs(a - b) <= ENERGY_SHARE * (least + abs(b))).all()) for a, b in pairs)


def _end(registration: Registration, logged: Record) -> float:
    """Degrees from the last rotation of a motion to the nearest optimum."""
    q = lift(quaternion_from_matrix(named(logged.states[-1], MATRIX_STATE)["R"])).integers
    return math.degrees(registration.solution.spectrum.angle_to_optimum(q))
