"""The report of a certificate in a file: the proof is checked, all else computed anew.

The registration is computed again from the points, and the body simulated again with the damping
and the integrator that the certificate names. Of the pose no more is said to be proved than the
certificate given proves, be it less than certreg would prove.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.checking import CertificateVerdict, verify
from certreg.certificate.consensus import ConsensusBody, ConsensusSimilarityBody
from certreg.certificate.count import CountBody
from certreg.certificate.envelope import Certificate, body_of
from certreg.certificate.isotropic import IsotropicBody, SimilarityBody
from certreg.certificate.listing import SpringsListBody
from certreg.certificate.truncated import TruncatedRotationBody
from certreg.errors import InvalidFileError, RefusedCertificateError
from certreg.io.streams import reading
from certreg.native.loops import Integrator
from certreg.problem.bounds import bounded
from certreg.problem.motion import MAX_DAMPING, MIN_DAMPING, Scale
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.registration.consensus import restated_consensus
from certreg.registration.linear import CROSS_CHECK
from certreg.registration.pipeline import Asked
from certreg.registration.quartic import SPRING_KINDS
from certreg.registration.squares import certified_squares
from certreg.registration.truncated import restated_truncated
from certreg.report.page import Report
from certreg.report.pair_page import PairsReport
from certreg.verify import FILE_MAX, Clouds, shown

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from certreg.certificate.bounds import PoseBounds
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.report.any_report import AnyReport
    from certreg.results import Verdict


SPRING = 12 * 8  # bytes of two points and six entries of a factor
BOUNDED_PAIR = 8 * 8  # bytes of two points, a weight and a bound
BOUNDED_SPRING = 13 * 8  # bytes of two points, a bound and a factor
PAIR = 7 * 8  # bytes of two points and a weight; the data end with these, after a header
WEAKER = 1e3  # times the bounds that certreg proves: the page warns of such a certificate


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionOptions:
    """How the body is simulated, and a sentence on it. integrator: None for not at all.

    damping: None for that of the fastest decay.
    """

    damping: float | None
    integrator: str | None
    words: str

    @classmethod
    def of(cls, about: dict[str, Any], problem: RegistrationProblem) -> MotionOptions:
        """As the `about` of a certificate says; where it does not, as usual, and it is told."""
        damping, integrator = about.get("damping"), about.get("integrator", "")
        known, usual = [one.value for one in Integrator], CROSS_CHECK.value
        best = "optimal damping"
        if problem.scaled:  # of a body whose size moves one integrator alone is written
            usual, best = Integrator.MIDPOINT.value, f"damping {problem.damping:g}"
            known = [usual]
        usable = isinstance(damping, float) and MIN_DAMPING <= damping <= MAX_DAMPING
        if problem.scale.divides:
            words = "no motion is computed anew: the symmetric scale is that of no springs"
            return cls(damping=None, integrator=usual, words=words)
        if not isinstance(damping, float) or not usable or integrator not in (None, *known):
            words = (
                "the certificate names no damping and integrator of this version: the motion is "
                f"computed anew with the defaults, {best} and {usual}"
            )
            return cls(damping=None, integrator=usual, words=words)
        words = (
            f"the motion is computed anew, with damping {damping:.6g} and integrator {integrator}"
        )
        if integrator is None:
            words = "the certificate was made without a simulation: no motion is computed anew"
        return cls(damping=damping, integrator=integrator, words=words)


def report_of(
    certificate: str | os.PathLike[str],
    points: RegistrationProblem | Clouds | None = None,
    *,
    noted: Callable[[str], None] | None = None,
) -> AnyReport[Any]:
    """The report of a certificate of optimality.

    points: where the certificate does not hold them; where it does and both are given, it must be
        about exactly these, weighted as they are. noted: hears in a sentence how the motion is
        computed.
    Raises InvalidFileError for other files, RefusedCertificateError where the checker refuses.
    """
    file = Path(certificate)
    with reading(file) as stream:
        content = stream.read(FILE_MAX + 1)
    loaded = _loaded(content)
    body = None if loaded is None else _required_body(loaded, file, pointless=points is None)
    verdict = verify(content, points)
    if loaded is None or body is None or not verdict.proved:
        raise RefusedCertificateError(
            f"{shown(file)}: REFUSED: {verdict.words}: there is nothing to report", verdict=verdict
        )
    if isinstance(body, (ConsensusBody, ConsensusSimilarityBody)):
        return _consensus_report(replace(loaded, body=body), content, verdict, file)
    if isinstance(body, TruncatedRotationBody):
        return _truncated_report(replace(loaded, body=body), content, verdict, file)
    stated = points if isinstance(points, RegistrationProblem) else _problem(loaded, points)
    if stated.factors is not None:
        return _spring_report(stated, replace(loaded, body=body), content, verdict, file.name)
    motion = MotionOptions.of(loaded.about, stated)
    if noted is not None:
        noted(motion.words)
    registration = certified_squares(
        stated if motion.damping is None else stated.damped(motion.damping),
        Asked(
            relaxation=isinstance(body, IsotropicBody) and body.multiplier is not None,
            simulation=motion.integrator is not None and Integrator(motion.integrator),
            about=loaded.about,
        ),
    )
    proved = registration.as_proved(body)
    return Report(
        registration=replace(proved, verdict=verdict),
        certificate=replace(loaded, body=body),
        content=content,
        verdict=verdict,
        name=file.name,
        weak=_weaker(proved.bounds, registration.bounds),
    )


def certified_pose(certificate: str | os.PathLike[str]) -> Pose | Similarity:
    """The pose of a certificate that holds its points, as `certify` gave it, computed anew.

    Raises InvalidFileError for other files, RefusedCertificateError where the checker refuses.
    """
    file = Path(certificate)
    with reading(file) as stream:
        loaded = _loaded(stream.read(FILE_MAX + 1))
    if loaded is not None and loaded.data is None:
        raise InvalidFileError(
            f"{shown(file)}: holds no points, from which its pose is computed: give the result or "
            "the pose file that certify --out wrote beside it",
            path=file,
        )
    return report_of(file).registration.pose


def _loaded(content: bytes) -> Certificate[Any] | None:
    """The certificate; None where it is not well-formed, and the checker says why."""
    try:
        return Certificate.load(content)
    except InvalidFileError:
        return None


def _required_body(certificate: Certificate[Any], file: Path, *, pointless: bool) -> Any:
    """InvalidFileError for a certificate of which no report can be made, sound as it may be."""
    body = certificate.body
    if isinstance(body, (CountBody, SpringsListBody)):
        held = "holds no pose" if isinstance(body, CountBody) else "`certreg verify` tells in words"
        what = f"is a certificate of kind {shown(body.KIND)}, which {held}"
        raise InvalidFileError(
            f"{shown(file)}: {what}: give the certificate.json that certify wrote", path=file
        )
    if certificate.data is None and pointless:
        raise InvalidFileError(
            f"{shown(file)}: holds no points, only their digest: give SOURCE TARGET, too", path=file
        )
    return body


def _problem(certificate: Certificate[Any], clouds: Clouds | None) -> RegistrationProblem:
    """The problem of a certificate that the checker has accepted for the clouds."""
    body = certificate.body
    sprung = body.KIND in SPRING_KINDS
    points = _spring_problem(certificate) if sprung else _weighted(certificate, clouds)
    scale = Scale(body.scale) if isinstance(body, SimilarityBody) else Scale.NONE
    return points.modelled(scale, rotation_only=body.rotation_only)


def _weighted(certificate: Certificate[Any], clouds: Clouds | None) -> RegistrationProblem:
    """Its points and weights."""
    n, data = certificate.n, certificate.data
    if data is None and clouds is not None:
        source, target = (np.array(cloud).reshape(n, 3) for cloud in (clouds.source, clouds.target))
        weights = None if clouds.weights is None else np.array(clouds.weights)
        return RegistrationProblem(source, target, weights=weights)
    data = data or b""
    doubles = np.frombuffer(data, dtype="<f8", offset=len(data) - PAIR * n)
    source, target, weights = np.split(doubles, [3 * n, 6 * n])
    return RegistrationProblem(source.reshape(n, 3), target.reshape(n, 3), weights=weights)


def _spring_problem(certificate: Certificate[Any]) -> RegistrationProblem:
    """The points and springs of a certificate that the checker has accepted for the clouds."""
    n, data = certificate.n, certificate.data or b""
    if not data:
        raise InvalidFileError(
            "the certificate holds no springs: give the problem that it is about"
        )
    doubles = np.frombuffer(data, dtype="<f8", offset=len(data) - SPRING * n)
    source, target, factors = np.split(doubles, [3 * n, 6 * n])
    return RegistrationProblem(
        source.reshape(n, 3), target.reshape(n, 3), factors=factors.reshape(n, 6)
    )


def _spring_report(
    problem: RegistrationProblem,
    certificate: Certificate[Any],
    content: bytes,
    verdict: Verdict,
    name: str,
) -> Report:
    """The report of a certificate of general springs: its pose, and what it proves of that."""
    registration = certified_squares(problem, Asked(about=certificate.about))
    proved = registration.as_proved(certificate.body)
    given = replace(proved.solution, certificate=certificate)
    return Report(
        registration=replace(proved, solution=given, verdict=verdict),
        certificate=certificate,
        content=content,
        verdict=verdict,
        name=name,
        weak=_weaker(proved.bounds, registration.bounds),
    )


def _consensus_report(
    certificate: Certificate[Any], content: bytes, verdict: Verdict, file: Path
) -> PairsReport:
    """The report of a certificate of wrong pairs: of its fit no more than it proves itself."""
    n, data, fields = certificate.n, certificate.data or b"", certificate.body.fit
    if fields is None or not data:
        raise InvalidFileError(
            f"{shown(file)}: holds no least squares, or no points: there is no pose to report",
            path=file,
        )
    stated = _bounded_problem(certificate.body, n, data)
    result = restated_consensus(stated, certificate, verdict)
    proved = result.fit.as_proved(body_of(fields))
    return PairsReport(
        registration=replace(result, fit=proved),
        certificate=certificate,
        content=content,
        verdict=verdict,
        name=file.name,
        weak=_weaker(proved.bounds, result.fit.bounds),
    )


def _truncated_report(
    certificate: Certificate[TruncatedRotationBody],
    content: bytes,
    verdict: CertificateVerdict,
    file: Path,
) -> PairsReport:
    """The report of a certificate of truncated squares: of its rotation what it proves."""
    n, data = certificate.n, certificate.data or b""
    if not data:
        raise InvalidFileError(
            f"{shown(file)}: holds no points: a report of truncated squares needs the "
            "certificate.json that certify wrote",
            path=file,
        )
    doubles = np.frombuffer(data, dtype="<f8", offset=len(data) - BOUNDED_PAIR * n)
    source, target, _, bounds = np.split(doubles, [3 * n, 6 * n, 7 * n])
    points = RegistrationProblem(source.reshape(n, 3), target.reshape(n, 3), rotation_only=True)
    return PairsReport(
        registration=restated_truncated(
            bounded(points, bounds, Loss.TRUNCATED), certificate, verdict
        ),
        certificate=certificate,
        content=content,
        verdict=verdict,
        name=file.name,
    )


def _bounded_problem(
    body: ConsensusBody | ConsensusSimilarityBody, n: int, data: bytes
) -> RegistrationProblem:
    """The pairs of a certificate, each with its bound, and a weight or a spring."""
    sprung = isinstance(body, ConsensusBody) and body.springs
    size = BOUNDED_SPRING if sprung else BOUNDED_PAIR
    doubles = np.frombuffer(data, dtype="<f8", offset=len(data) - size * n)
    source, target, own, others = np.split(doubles, [3 * n, 6 * n, 7 * n])
    bounds = own if sprung else others
    held: dict[str, Any] = {"factors": others.reshape(n, 6)} if sprung else {"weights": own}
    if isinstance(body, ConsensusSimilarityBody):
        held["scale"] = body.scale
    stated = RegistrationProblem(source.reshape(n, 3), target.reshape(n, 3), **held)
    return bounded(stated, bounds)


def _weaker(given: PoseBounds | None, proved: PoseBounds | None) -> bool:
    """Whether a certificate proves far less of a pose than certreg does."""
    if given is None or proved is None:
        return False
    if given.greatest_gap > Fraction(WEAKER) * proved.greatest_gap:
        return True
    if proved.angle_upper is None:
        return False
    return given.angle_upper is None or given.angle_upper > WEAKER * proved.angle_upper
