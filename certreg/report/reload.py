"""The report of a certificate in a file: the proof is checked, all else computed anew.

The registration is computed again from the points, and the body simulated again with the damping
and the integrator that the certificate names. Of the pose no more is said to be proved than the
certificate given proves, be it less than certreg would prove.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.checking import CertificateVerdict, verify
from certreg.certificate.envelope import Certificate, body_of
from certreg.errors import InvalidFileError, RefusedCertificateError
from certreg.io.streams import reading
from certreg.native.loops import Integrator
from certreg.problem.bounds import bounded
from certreg.problem.motion import MAX_DAMPING, MIN_DAMPING
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss, Verb, refusal
from certreg.registration.consensus import restated_consensus
from certreg.registration.linear import CROSS_CHECK
from certreg.registration.pipeline import Asked
from certreg.registration.problem_arguments import is_problem
from certreg.registration.squares import certified_squares
from certreg.registration.truncated import restated_truncated
from certreg.report.page import Report
from certreg.report.pair_page import PairsReport
from certreg.verify import FILE_MAX, Clouds, shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.certificate.bounds import PoseBounds
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.report.any_report import AnyReport


WEIGHED, SPRUNG = {"weights": 1}, {"factors": 6}  # columns of a row after its points
BOUNDED, BOUNDED_SPRUNG = {"weights": 1, "bounds": 1}, {"bounds": 1, "factors": 6}
WEAKER = 1e3  # times the bounds that certreg proves: the page warns of such a certificate


@dataclass(frozen=True, slots=True, kw_only=True)
class Accepted:
    """A certificate that the checker has accepted, and what it was given with.

    content: of the file. points: None where the certificate holds them. noted: hears in a sentence
    how the motion is computed.
    """

    certificate: Certificate[Any]
    content: bytes
    verdict: CertificateVerdict
    file: Path
    points: RegistrationProblem | Clouds | None
    noted: Callable[[str], None] | None

    @property
    def problem(self) -> RegistrationProblem:
        """What it is about: as it was given, or as the certificate holds it."""
        if is_problem(self.points):
            return self.points
        return _problem(self.certificate, self.points)

    def fields(self, given: PoseBounds | None = None, own: PoseBounds | None = None) -> Any:
        """What a report has beside its registration; given, own: what is proved of the pose."""
        return {
            "certificate": self.certificate,
            "content": self.content,
            "verdict": self.verdict,
            "name": self.file.name,
            "weak": _weaker(given, own),
        }

    def require_data(self, words: str, *, held: bool = True) -> None:
        """Raises InvalidFileError where the points, or what else is held, are not in the file."""
        if not (held and self.certificate.data):
            raise InvalidFileError(f"{shown(self.file)}: {words}", path=self.file)

    def squares(self, problem: RegistrationProblem, asked: Asked) -> Report:
        """The report of least squares: the pose computed anew, with what is proved of it."""
        own = certified_squares(problem, asked)
        proved = own.as_proved(self.certificate.body)
        return Report(
            registration=replace(proved, verdict=self.verdict),
            **self.fields(proved.bounds, own.bounds),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """How certificates of a kind are read again.

    columns: of a row of their data after its two points. options: of the problem that they are
    about, by the body. report: of one that was accepted. relaxed: whether the body has a proof of
    the relaxation. in_clouds: whether two clouds with weights state such a problem.
    """

    columns: Callable[[Any], dict[str, int]]
    report: Callable[[Accepted], AnyReport[Any]]
    options: Callable[[Any], dict[str, Any]] = lambda _: {}
    relaxed: Callable[[Any], bool] = lambda _: False
    in_clouds: bool = True


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
        cell, names = problem.cell, [one.value for one in Integrator]
        known = [name for name in names if refusal(cell, Verb(name)) is None]
        usual = CROSS_CHECK.value if CROSS_CHECK.value in known else Integrator.MIDPOINT.value
        best = "optimal damping"
        if refusal(cell, Verb.DAMPING) is not None:
            best = f"damping {problem.damping:g}"
        usable = isinstance(damping, float) and MIN_DAMPING <= damping <= MAX_DAMPING
        if not known:
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
    if loaded is not None:
        _require_pose(loaded, file, pointless=points is None)
    verdict = verify(content, points)
    if loaded is None or not verdict.proved:
        raise RefusedCertificateError(
            f"{shown(file)}: REFUSED: {verdict.words}: there is nothing to report", verdict=verdict
        )
    accepted = Accepted(
        certificate=loaded,
        content=content,
        verdict=verdict,
        file=file,
        points=points,
        noted=noted,
    )
    return STORED[loaded.body.KIND].report(accepted)


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


def _require_pose(certificate: Certificate[Any], file: Path, *, pointless: bool) -> None:
    """InvalidFileError for a certificate of which no report can be made, sound as it may be."""
    kind = certificate.body.KIND
    if kind in WITHOUT_POSE:
        what = f"is a certificate of kind {shown(kind)}, which {WITHOUT_POSE[kind]}"
        raise InvalidFileError(
            f"{shown(file)}: {what}: give the certificate.json that certify wrote", path=file
        )
    if certificate.data is None and pointless:
        raise InvalidFileError(
            f"{shown(file)}: holds no points, only their digest: give SOURCE TARGET, too", path=file
        )


def _problem(certificate: Certificate[Any], clouds: Clouds | None = None) -> RegistrationProblem:
    """The problem of a certificate that the checker has accepted for the clouds."""
    stored, n = STORED[certificate.body.KIND], certificate.n
    options = stored.options(certificate.body)
    if not certificate.data and clouds is not None:
        if not stored.in_clouds:
            raise InvalidFileError(
                "the certificate holds no springs: give the problem that it is about"
            )
        source, target = (np.array(cloud).reshape(n, 3) for cloud in (clouds.source, clouds.target))
        weights = None if clouds.weights is None else np.array(clouds.weights)
        return RegistrationProblem(source, target, weights=weights, **options)
    rows = _rows(certificate)
    bounds = rows.pop("bounds", None)
    problem = RegistrationProblem(**rows, **options)
    return problem if bounds is None else bounded(problem, bounds)


def _rows(certificate: Certificate[Any]) -> dict[str, NDArray[np.float64]]:
    """The arrays in the data, which end with them, after a header."""
    n, data = certificate.n, certificate.data or b""
    widths = {"source": 3, "target": 3, **STORED[certificate.body.KIND].columns(certificate.body)}
    size = 8 * n * sum(widths.values())
    doubles = np.frombuffer(data, dtype="<f8", offset=len(data) - size)
    ends = np.cumsum([n * width for width in widths.values()])
    parts = zip(widths.items(), np.split(doubles, ends), strict=False)
    return {name: one.reshape(n, width) if width > 1 else one for (name, width), one in parts}


def _weighted(accepted: Accepted) -> AnyReport[Any]:
    """Of one weight per pair: the body moves as the certificate says."""
    certificate, stated = accepted.certificate, accepted.problem
    motion = MotionOptions.of(certificate.about, stated)
    if accepted.noted is not None:
        accepted.noted(motion.words)
    asked = Asked(
        relaxation=STORED[certificate.body.KIND].relaxed(certificate.body),
        simulation=motion.integrator is not None and Integrator(motion.integrator),
        about=certificate.about,
    )
    damped = stated if motion.damping is None else stated.damped(motion.damping)
    return accepted.squares(damped, asked)


def _sprung(accepted: Accepted) -> AnyReport[Any]:
    """Of general springs: its pose, and what it proves of that."""
    certificate = accepted.certificate
    report = accepted.squares(accepted.problem, Asked(about=certificate.about))
    proved = report.registration
    given = replace(proved.solution, certificate=certificate)
    return replace(report, registration=replace(proved, solution=given))


def _consensus(accepted: Accepted) -> AnyReport[Any]:
    """Of wrong pairs: of its fit no more than it proves itself."""
    certificate = accepted.certificate
    fields = certificate.body.fit
    accepted.require_data(
        "holds no least squares, or no points: there is no pose to report", held=fields is not None
    )
    result = restated_consensus(_problem(certificate), certificate, accepted.verdict)
    proved = result.fit.as_proved(body_of(fields))
    return PairsReport(
        registration=replace(result, fit=proved),
        **accepted.fields(proved.bounds, result.fit.bounds),
    )


def _truncated(accepted: Accepted) -> AnyReport[Any]:
    """Of truncated squares: of its rotation what it proves."""
    certificate = accepted.certificate
    accepted.require_data(
        "holds no points: a report of truncated squares needs the certificate.json that certify "
        "wrote"
    )
    rows = _rows(certificate)
    points = RegistrationProblem(rows["source"], rows["target"], rotation_only=True)
    problem = bounded(points, rows["bounds"], Loss.TRUNCATED)
    result = restated_truncated(problem, certificate, accepted.verdict)
    return PairsReport(registration=result, **accepted.fields())


def _turning(body: Any) -> dict[str, Any]:
    return {"rotation_only": body.rotation_only}


SPRINGS = Stored(columns=lambda _: SPRUNG, report=_sprung, options=_turning, in_clouds=False)
STORED: Mapping[str, Stored] = {  # by the kind that a file names
    "isotropic": Stored(
        columns=lambda _: WEIGHED,
        report=_weighted,
        options=_turning,
        relaxed=lambda body: body.multiplier is not None,
    ),
    "similarity": Stored(
        columns=lambda _: WEIGHED,
        report=_weighted,
        options=lambda body: {**_turning(body), "scale": body.scale},
    ),
    "springs-sos": SPRINGS,
    "springs-cones": SPRINGS,
    "consensus": Stored(
        columns=lambda body: BOUNDED_SPRUNG if body.springs else BOUNDED, report=_consensus
    ),
    "consensus-similarity": Stored(
        columns=lambda _: BOUNDED,
        report=_consensus,
        options=lambda body: {"scale": body.scale},
    ),
    "truncated-rotation": Stored(columns=lambda _: BOUNDED, report=_truncated),
}
WITHOUT_POSE = {"count": "holds no pose", "springs-list": "`certreg verify` tells in words"}


def _weaker(given: PoseBounds | None, proved: PoseBounds | None) -> bool:
    """Whether a certificate proves far less of a pose than certreg does."""
    if given is None or proved is None:
        return False
    if given.greatest_gap > Fraction(WEAKER) * proved.greatest_gap:
        return True
    if proved.angle_upper is None:
        return False
    return given.angle_upper is None or given.angle_upper > WEAKER * proved.angle_upper
