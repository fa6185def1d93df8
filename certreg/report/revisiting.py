"""The report of a certificate in a folder: what is proved is proved anew, what is slow is reused.

The certificate is checked, and the registration computed again from the points in it: nothing shown
as exact rests on another file. Of the pose no more is said to be proved than the certificate given
proves, be it less than certreg would prove. Only the roads that take long are taken from
`result.json` and `trajectory.npz` beside it, where the digest says that they belong to it.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from certreg.certificate.bounds import ExactPose, PoseBounds, pose_bounds
from certreg.certificate.checking import verify
from certreg.certificate.types import ISOTROPIC, Certificate, Claims
from certreg.dyadic import Dyadic
from certreg.errors import InvalidFileError, RefusedCertificateError
from certreg.io.streams import reading
from certreg.io.trajectories import read_record
from certreg.pipeline import certify
from certreg.problem import MAX_DAMPING, MIN_DAMPING, RegistrationProblem
from certreg.report.document import RESULT_SCHEMA
from certreg.report.folder import RESULT, TRAJECTORY
from certreg.report.page import Report
from certreg.report.panel import Roads
from certreg.settings import DEFAULT_DAMPING, FileSettings, ReportSettings
from certreg.verify import FILE_MAX, RefusalError, bound_doubles, parse, shown

if TYPE_CHECKING:
    import os

    from certreg.io.trajectories import Record
    from certreg.pipeline import Registration


@dataclass(frozen=True, slots=True, kw_only=True)
class Known:
    """What a result says of roads that take long; angles in degrees, None where not taken."""

    damping: float
    relaxation: float | None
    simulation: float | None


def report_of(certificate: str | os.PathLike[str]) -> Report:
    """The report of a certificate of optimality that holds its points.

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
    fields = parse(content)
    known = _known(file.with_name(RESULT), fields["digest"])
    problem = _problem(fields, DEFAULT_DAMPING if known is None else known.damping)
    logged = None if known is None else _logged(file.with_name(TRAJECTORY), problem)
    registration = certify(
        problem,
        relaxation=known is None,
        simulation=known is None or (logged is None and known.simulation is not None),
    )
    roads = Roads.of(registration.solution.agreement)
    if known is not None:
        roads = Roads(
            closed_form=roads.closed_form,
            relaxation=known.relaxation,
            simulation=known.simulation if roads.simulation is None else roads.simulation,
        )
    given = _bounds(fields, registration)
    return Report(
        registration=replace(registration, bounds=given, verdict=verdict),
        certificate=content,
        verdict=verdict,
        weak=_weaker(given, registration.bounds),
        logged=logged or registration.solution.trajectory,
        roads=roads,
    )


def _bounds(fields: dict[str, Any], registration: Registration) -> PoseBounds:
    """What the certificate given proves of the pose that was computed anew."""
    claims = Claims(
        gap=_dyadic(fields["gap"]),
        sin2_half_angle=None if (sin2 := fields["sin2_half_angle"]) is None else _dyadic(sin2),
        unique=fields["unique"],
        pattern=tuple(fields["pattern"]),
        unstable=None,
    )
    certificate = Certificate(
        n=fields["n"],
        digest=fields["digest"],
        data=None,
        quaternion=tuple(fields["pose"]),
        mu=_dyadic(fields["mu"]),
        delta=_dyadic(fields["delta"]),
        claims=claims,
    )
    pose = registration.pose
    place = ExactPose.of_doubles(pose.quaternion_wxyz, pose.translation)
    return pose_bounds(registration.solution.moments, certificate, place)


def _dyadic(value: Fraction) -> Dyadic:
    """A number of a certificate, whose denominator is a power of two."""
    return Dyadic(mantissa=value.numerator, exponent=1 - value.denominator.bit_length())


def _weaker(given: PoseBounds, proved: PoseBounds | None) -> bool:
    """Whether a certificate proves far less of a pose than certreg does."""
    if proved is None:
        return False
    factor = ReportSettings().weaker
    if given.greatest_gap > Fraction(factor) * proved.greatest_gap:
        return True
    if proved.angle_upper is None:
        return False
    return given.angle_upper is None or given.angle_upper > factor * proved.angle_upper


def _require_points(content: bytes, file: Path) -> None:
    """InvalidFileError for a certificate of which no report can be made, sound as it may be."""
    try:
        fields = parse(content)
    except (RefusalError, MemoryError):
        return  # the checker says why
    if fields["kind"] != ISOTROPIC:
        what = f"is a certificate of kind {shown(fields['kind'])}, which holds no pose"
        message = f"{shown(file)}: {what}: give the certificate.json that certify wrote"
        raise InvalidFileError(message)
    if fields["data"] is None:
        message = f"{shown(file)}: holds no points: certify --out writes the report of so many"
        raise InvalidFileError(message)


def _problem(fields: dict[str, Any], damping: float) -> RegistrationProblem:
    n = fields["n"]
    doubles = np.frombuffer(bound_doubles(fields, None), dtype="<f8")
    source, target, weights = np.split(doubles, [3 * n, 6 * n])
    return RegistrationProblem(
        source.reshape(n, 3), target.reshape(n, 3), weights=weights, damping=damping
    )


def _known(file: Path, digest: str) -> Known | None:
    """What a result of this problem says; None if there is none, or of another, or broken."""
    if not file.is_file():  # to open a pipe would wait for whoever writes to it
        return None
    try:
        with reading(file) as stream:
            text = stream.read(FileSettings().max_pose_bytes + 1)
        document: Any = json.loads(text)
        if (document["schema"], document["digest"]) != (RESULT_SCHEMA, digest):
            return None
        agreement = document["agreement"]
        known = Known(
            damping=document["damping"],
            relaxation=agreement["relaxation_deg"],
            simulation=agreement["simulation_deg"],
        )
    except (InvalidFileError, ValueError, RecursionError, KeyError, TypeError):
        return None
    angles = [angle for angle in (known.relaxation, known.simulation) if angle is not None]
    numbers = cast("list[Any]", [known.damping, *angles])
    plain = all(isinstance(value, float) and math.isfinite(value) for value in numbers)
    return known if plain and MIN_DAMPING <= known.damping <= MAX_DAMPING else None


def _logged(file: Path, problem: RegistrationProblem) -> Record | None:
    """The trajectory of this problem under this damping; None if there is none, or broken."""
    if not file.is_file():
        return None
    try:
        record = read_record(file)
    except InvalidFileError:
        return None
    mine = (record.digest, record.damping) == (problem.digest(), problem.damping)
    return record if mine else None
