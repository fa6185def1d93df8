"""The viewer, the part of the page where the bodies move: its words, and what its script draws.

The script reads equilibria, motions and labels from a document; the points are in the certificate.
A module beside the page, which alone uses it: together they would be too long to read.
"""

from __future__ import annotations

import base64
import math
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.exact.dyadic import nearest_double
from certreg.problem.lifting import lift
from certreg.report.lines import margin_words, number, unit_words
from certreg.report.markup import printable
from certreg.report.scene_words import component_name, component_words, factor_words, lie_words
from certreg.report.thinning import UNSPENT, Run, left_words, shown_motion, simulated_escapes
from certreg.results import Absent, Optimality

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.equilibrium.equilibrium_set import Component
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.linear import LinearSolution
    from certreg.registration.result import Registration
    from certreg.results import Json


SPRINGS_WORDS = (
    "Each pair is joined by a spring, and the source moves as one rigid body, with friction, until "
    "it rests. Where it can rest is known completely."
)
RESTING_WORDS = (
    "Each pair is joined by a spring. Where the springs balance is known completely; how the "
    "source would move is not defined."
)
INDEX_WORDS = "The index counts the independent turns that lower the energy: 0 only at the best."
GZIP = 31  # of zlib's window bits: with a header of gzip, which browsers unpack
NO_MOTION = "Nothing moves here: "
UNDEFINED = "the source points {lie}, so the dynamics of the body is not defined."
WATCH = " Push it, and watch."
NOT_SIMULATED = "the motion was not simulated."
FAR_SIGMAS = 10  # 6.5 medians of Gaussian noise: the middle colour is at five
FAR_MEDIANS = 6  # from which a row may be called an outlier
NAMED = 12  # points with their names in the scene; more would hide it
SAMPLE = 100_000  # points shown where the page holds no certificate with them


def viewer_words(registration: Registration) -> dict[str, Any]:
    """The words of the viewer, as its template shows them: a button for each stationary pose."""
    moves = registration.equilibria.classification.inertia_definite
    return {
        "springs_words": SPRINGS_WORDS if moves else RESTING_WORDS,
        "index_words": INDEX_WORDS,
        "rests": [_rest(registration, i) for i in range(len(registration.equilibria.components))],
    }


def _rest(registration: Registration, index: int) -> dict[str, Any]:
    equilibria = registration.equilibria
    component = equilibria.components[index]
    away = math.degrees(component.angle_to_optimum)
    notes = [f"RMSE {number(_rmse(registration, component))}"]
    if not component.optimal:
        factor = "" if registration.fit.rounded else factor_words(equilibria, index)
        notes += filter(None, [factor, f"{away:.4g}° from the optimum"])
    return {
        "name": component_name(equilibria, index),
        "notes": notes,
        "badge": f"index {component.morse_index}",
        "attributes": {
            "class": "rest best" if component.optimal else "rest wrong",
            "data-component": index,
        },
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class Names:
    """What the certificate says of the points, unproved: names of the files, labels if it has them.

    Control characters are escaped.
    """

    source: str
    target: str
    labels: tuple[str, ...] | None

    @classmethod
    def of(cls, about: dict[str, Any], n: int) -> Names:
        """The names in the `about` of a certificate, whatever else it holds."""
        labels: Json = about.get("labels")
        named = [about.get(key) for key in ("source", "target")]
        source, target = (
            printable(name) if isinstance(name, str) and name else default
            for name, default in zip(named, ("source", "target"), strict=True)
        )
        listed = labels if isinstance(labels, list) else []
        texts = [printable(label) for label in listed if isinstance(label, str)]
        whole = len(texts) == len(listed) == n
        return cls(source=source, target=target, labels=tuple(texts) if whole else None)


def scene_document(registration: Registration, names: Names) -> dict[str, Any]:
    """What the script of the page reads beside the certificate."""
    problem, solution = registration.problem, registration.solution
    equilibria = registration.equilibria
    trajectory = solution.trajectory
    runs = [] if isinstance(trajectory, Absent) else [shown_motion(solution, trajectory)]
    runs += simulated_escapes(solution, problem.damping)
    exponent = runs[0].length_exponent if runs else 0
    unit = solution.moments.total_weight * (4**exponent if exponent >= 0 else 1)
    if exponent < 0:
        unit /= 4**-exponent
    defined = equilibria.classification.inertia_definite
    pushed = {run.start for run in runs}
    undefined = UNDEFINED.format(lie=lie_words(registration))
    return {
        "n": problem.n,
        "labels": names.labels,
        "rounded": registration.fit.rounded,
        "unit": unit_words(registration.fit),
        "colours": colours_end(registration),
        "components": [
            {
                "name": component_name(equilibria, i),
                "rmse": number(_rmse(registration, component)),
                "words": component_words(equilibria, i) + (WATCH if i in pushed else ""),
                "dimension": component.kind.dimension,
                "basis": component.basis.T.tolist(),
                "quaternion": component.quaternion_wxyz.tolist(),
                "index": component.morse_index,
                "optimal": component.optimal,
                "eigenvalues": _pairs(component.eigenvalues),
                "level": nearest_double(solution.objective.energy(q) / unit),
            }
            for i, (component, q) in enumerate(
                zip(equilibria.components, solution.objective.quaternions, strict=True)
            )
        ],
        "runs": [{**run.fields, "ended": ended_words(solution, run)} for run in runs],
        "still": None if runs else NO_MOTION + (NOT_SIMULATED if defined else undefined),
        "energy_unit": nearest_double(unit),
        "margin": {"relative": equilibria.margin.relative, "words": margin_words(equilibria)},
        "axes": _axes(problem.target).tolist(),
        "named": _named(registration, names.labels),
    }


def told_rmse(registration: Registration) -> float | None:
    """The RMSE of the optimum, as the page tells it everywhere: that of the pose as printed.

    Where the pose is bounded alone, the two are not the same.
    """
    bounded = registration.status is Optimality.BOUNDED
    return registration.equilibria.components[0].rmse if bounded else registration.rmse


def _rmse(registration: Registration, component: Component) -> float | None:
    return told_rmse(registration) if component.optimal else component.rmse


def colours_end(registration: Registration) -> dict[str, Any]:
    """The distance at the end of the colours at the optimum, None: the largest; and what it is.

    Red is what a sound fit does not have: ten sigma, or the largest where it is more, so that one
    wrong row is told from those that it pulls off. Without sigma and without a warning six medians
    are far, as for outlying rows; a fit that is warned of shows which pairs are the farthest.
    """
    problem, fit = registration.problem, registration.fit
    if problem.noise_given and problem.equally_weighted:
        sigma = 1.0 / math.sqrt(problem.weights[0])
        most = fit.worst[0].residual / sigma if fit.worst else 0.0
        if most <= FAR_SIGMAS:
            return {"end": FAR_SIGMAS * sigma, "words": f"{FAR_SIGMAS} σ"}
        return {"end": None, "words": f"the largest, {most:.3g} σ"}
    ratio = fit.largest_over_median_residual
    if ratio is not None and ratio <= FAR_MEDIANS and not fit.warnings:
        end = FAR_MEDIANS / ratio * fit.worst[0].residual
        if math.isfinite(end):
            return {"end": end, "words": f"{FAR_MEDIANS} × the median"}
    return {"end": None, "words": "the largest"}


def ended_words(solution: LinearSolution, run: Run) -> str:
    """Where a run ended, and how."""
    unique = solution.equilibria.classification.unique
    kicked = "It stood at a saddle and was kicked off. " if run.escapes else ""
    if run.converged and run.left > UNSPENT:
        return f"{kicked}It is slower than the tolerance, {left_words(run.left)}."
    if run.converged:
        return f"{kicked}It comes to rest at {'the optimum' if unique else 'one of the optima'}."
    away = math.degrees(solution.objective.angle_to_optimum(lift(run.end).integers))
    where = "the optimum" if unique else "the nearest optimum"
    return f"{kicked}The steps ran out before it was at rest, {away:.3g}° from {where}."


def sample_of(problem: RegistrationProblem) -> str:
    """Evenly chosen pairs, for a page that does not hold all points."""
    step = -(-problem.n // SAMPLE)
    rows = slice(None, None, step)
    parts = (problem.source[rows], problem.target[rows], problem.weights[rows])
    body = b"".join(np.ascontiguousarray(part, dtype="<f8").tobytes() for part in parts)
    return base64.b64encode(body).decode("ascii")


def packed(certificate: bytes) -> str:
    """The bytes of a file for a page: gzip, then base64.

    Digits of measurements repeat nothing; to look for repetitions takes three times as long.
    """
    packer = zlib.compressobj(level=1, wbits=GZIP, strategy=zlib.Z_RLE)
    return base64.b64encode(packer.compress(certificate) + packer.flush()).decode("ascii")


def _pairs(values: NDArray[np.complex128] | None) -> list[list[float]] | None:
    if values is None or not np.isfinite(values).all():
        return None
    return [[value.real, value.imag] for value in values.tolist()]


def _named(registration: Registration, labels: tuple[str, ...] | None) -> list[tuple[int, str]]:
    """Rows that have their names in the scene: all of few with labels, else the outliers."""
    if labels is not None and len(labels) <= NAMED:
        return list(enumerate(labels))
    rows = registration.fit.outlier_rows
    return [(row, f"row {row}" if labels is None else labels[row]) for row in rows]


def _axes(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows: across, away and up, as the cloud is first seen. Right-handed.

    Up is z. Across is the longest horizontal direction, and to the back the cloud rises: a slope
    is seen from where it faces, not along its surface.
    """
    unit = float(np.abs(points).max()) or 1.0
    scaled = points / unit
    centred = scaled - scaled.mean(axis=0)
    flat = centred[:, :2] / (float(np.abs(centred).max()) or 1.0)
    x, y = np.linalg.eigh(flat.T @ flat)[1].T[0]  # the shortest
    rises = float(centred[:, 2] @ (flat @ [x, y])) >= 0.0
    away = np.array([x, y, 0.0]) * (1.0 if rises else -1.0)
    up = np.array([0.0, 0.0, 1.0])
    return np.stack([np.cross(away, up), away, up])
