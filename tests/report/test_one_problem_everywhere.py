"""A number of a registration is one number wherever it stands, and that of plain sums.

Random clouds in several units, with noise told by sigma, by one for each row, by weights or by
nothing, some rows without weight, with labels or without, in blocks of a few rows. The reference
knows NumPy alone: Kabsch's rotation, residuals row by row, the inverse of the normal matrix.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import write_csv
from scipy.spatial.transform import Rotation
from scipy.special import chdtrc

from certreg.campaign import pairs
from certreg.campaign.listing import read_listing
from certreg.problem import arrays
from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.report.cards import registration_card
from certreg.report.document import result_document
from certreg.report.lines import number
from certreg.report.overview import Overview
from certreg.report.residual_table import residual_table
from certreg.report.summary import registration_summary
from certreg.report.uncertainty import two_digits, uncertainty_rows
from certreg.results import Limits

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.registration.result import Registration

N, BLOCK = 11, 4
KINDS = ("sigma", "sigmas", "weights", "nothing")
UNITS = (1e-3, 1.0, 1e4)
CASES = [(kind, unit) for kind in KINDS for unit in UNITS]


@dataclass(frozen=True)
class Reference:
    """What plain sums say of clouds (N, 3) with weights (N,)."""

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    weights: NDArray[np.float64]
    estimated: bool

    @property
    def rotation(self) -> NDArray[np.float64]:
        x, y = self.centred
        u, _, vt = np.linalg.svd((self.weights[:, None] * y).T @ x)
        return u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt

    @property
    def centres(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        shares = self.weights / self.weights.sum()
        return shares @ self.source, shares @ self.target

    @property
    def centred(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        here, there = self.centres
        return self.source - here, self.target - there

    @property
    def translation(self) -> NDArray[np.float64]:
        here, there = self.centres
        return there - self.rotation @ here

    @property
    def distances(self) -> NDArray[np.float64]:
        moved = self.source @ self.rotation.T + self.translation
        return np.linalg.norm(self.target - moved, axis=1)

    @property
    def objective(self) -> float:
        return float(self.weights @ self.distances**2)

    @property
    def degrees(self) -> int:
        return 3 * int((self.weights > 0).sum()) - 6

    @property
    def variance(self) -> float:
        """Of a coordinate of weight one."""
        return self.objective / self.degrees if self.estimated else 1.0

    @property
    def sizes(self) -> tuple[float, float, float]:
        """Sums of w |x|^2, w |y|^2 and w y.R x about the centres."""
        (x, y), w = self.centred, self.weights
        return (
            float(w @ (x * x).sum(axis=1)),
            float(w @ (y * y).sum(axis=1)),
            float(w @ (y * (x @ self.rotation.T)).sum(axis=1)),
        )

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Of (dt, phi): twice the inverse of the Hessian of the objective, over its variance.

        Half of it is the sum of w J^T J, J = (I, -R [x]), but that turns cost tr(B) I - B about the
        centres, B = R^T C, in the place of the sum of w [x]^T [x].
        """
        (x, y), w, R = self.centred, self.weights, self.rotation
        B = R.T @ (w[:, None] * y).T @ x
        m = self.centres[0]
        arm = R @ np.cross(np.eye(3), m)  # R [m]
        half = np.block(
            [
                [w.sum() * np.eye(3), -w.sum() * arm],
                [-w.sum() * arm.T, np.trace(B) * np.eye(3) - (B + B.T) / 2 + w.sum() * arm.T @ arm],
            ]
        )
        scale = np.outer(*[np.sqrt(np.diag(half))] * 2)
        return self.variance * np.linalg.inv(half / scale) / scale


@dataclass(frozen=True)
class Case:
    """A problem, what certreg makes of it, and the reference."""

    registration: Registration
    reference: Reference
    document: dict[str, Any]
    text: str
    noise: dict[str, Any]


def options(kind: str, unit: float, rng: np.random.Generator) -> dict[str, Any]:
    """What states the noise: of a hundredth of the unit, or weights of which two are zero."""
    if kind == "sigma":
        return {"sigma": 0.01 * unit}
    if kind == "sigmas":
        return {"sigma": 0.01 * unit * rng.uniform(0.8, 1.25, N)}
    weights = rng.uniform(0.7, 1.4, N)
    weights[[2, 6]] = 0.0
    return {"weights": weights} if kind == "weights" else {}


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"{case[0]} {case[1]:g}")
def case(request: pytest.FixtureRequest) -> Case:
    kind, unit = request.param
    rng = np.random.default_rng(CASES.index(request.param))
    source = unit * (rng.standard_normal((N, 3)) * [3.0, 2.0, 1.0] + [5.0, -4.0, 3.0])
    noise = options(kind, unit, rng)
    given = np.broadcast_to(noise.get("sigma", 0.01 * unit), N)
    turn = Rotation.from_quat(rng.normal(size=4))
    target = turn.apply(source) + unit * np.array([7.0, 8.0, -9.0])
    target += given[:, None] * rng.standard_normal((N, 3))
    weights = noise.get("weights", np.ones(N)) if "sigma" not in noise else 1.0 / given**2
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(arrays, "BLOCK_POINTS", BLOCK)
        problem = RegistrationProblem(source, target, **noise)
        labels = [f"P{k}" for k in range(N)]
        registration = certify(
            problem, relaxation=False, simulation=False, about={"labels": labels}
        )
        return Case(
            registration=registration,
            reference=Reference(source, target, weights, estimated="sigma" not in noise),
            document=result_document(registration),
            text=registration_summary(registration),
            noise=noise,
        )


def near(value: Any, rel: float = 1e-7) -> Any:
    return pytest.approx(value, rel=rel, abs=0.0)


@pytest.mark.one_in(4)
def test_the_fit_is_that_of_plain_sums(case: Case):
    document, reference = case.document, case.reference
    rms = math.sqrt(reference.objective / reference.weights.sum())
    source, target, aligned = reference.sizes
    fit = document["fit"]

    assert (document["objective"], document["rmse"]) == (near(reference.objective), near(rms))
    assert fit["explained"] == near(aligned**2 / (source * target))
    assert fit["best_scale"] == near(aligned / source)
    carrying = np.flatnonzero(reference.weights > 0)
    distances = reference.distances
    ratio = float(distances[carrying].max() / np.median(distances[carrying]))
    assert fit["largest_over_median_residual"] == near(ratio)
    order = carrying[np.argsort(-distances[carrying])]
    assert [(one["row"], one["label"]) for one in fit["worst"]] == [
        (row, f"P{row}") for row in order[:10].tolist()
    ]
    assert [one["residual"] for one in fit["worst"]] == near(distances[order][:10].tolist())
    every = np.argsort(-distances)[:10].tolist()
    assert [one["row"] for one in document["residuals"]] == every
    assert [one["distance"] for one in document["residuals"]] == near(distances[every].tolist())
    assert fit["warnings"] == []
    if reference.estimated:
        assert fit["chi2"] is None
    else:
        p = chdtrc(reference.degrees, reference.objective)
        assert (fit["chi2"]["dof"], fit["chi2"]["p"]) == (reference.degrees, near(p))
        assert fit["chi2"]["value"] == near(reference.objective)


def test_the_deviations_are_those_of_the_normal_matrix(case: Case):
    pose, reference = case.document["pose"], case.reference
    covariance = reference.covariance
    sigmas = np.sqrt(np.diag(covariance))
    values, axes = np.linalg.eigh(covariance[3:, 3:])
    told = pose["uncertainty"]
    centre = math.sqrt(reference.variance / reference.weights.sum())

    shares = np.outer(sigmas, sigmas)
    assert np.array(pose["covariance"]) / shares == pytest.approx(covariance / shares, abs=1e-7)
    assert told["translation"] == near(sigmas[:3].tolist())
    assert told["rotation_deg"] == near(np.degrees(sigmas[3:]).tolist())
    assert told["centre"] == near(centre)
    assert told["loosest_turn"]["sigma_deg"] == near(math.degrees(math.sqrt(values[-1])))
    assert abs(np.dot(told["loosest_turn"]["axis"], axes[:, -1])) == near(1.0)
    assert told["degrees_of_freedom"] == reference.degrees
    assert pose["covariance_scale"] == ("estimated" if reference.estimated else "given")
    assert pose["variance_factor"] == near(reference.objective / reference.degrees)


def test_the_table_of_residuals_has_each_row(case: Case, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(arrays, "BLOCK_POINTS", BLOCK)
    reference = case.reference
    content = b"".join(residual_table(case.registration)).decode()
    rows = list(csv.DictReader(io.StringIO(content)))
    unit = math.sqrt(reference.variance)

    assert [(row["row"], row["label"]) for row in rows] == [(f"{k}", f"P{k}") for k in range(N)]
    assert [float(row["residual"]) for row in rows] == near(reference.distances.tolist())
    for row, weight, distance in zip(rows, reference.weights, reference.distances, strict=True):
        share = f"{row['standardised']}"
        assert (share == "") == (weight == 0.0)
        assert not share or float(share) == near(math.sqrt(weight) * distance / unit)


def test_screen_card_and_page_tell_the_numbers_of_the_document(case: Case):
    document, registration = case.document, case.registration
    rmse, uncertainty = number(document["rmse"]), document["pose"]["uncertainty"]
    rows = dict(uncertainty_rows(registration))
    card = registration_card(registration)
    overview = Overview.of(registration)
    said = {fact.name: f"{fact.value} {fact.words}".strip() for fact in overview.fit}
    shift = two_digits(uncertainty["translation"])

    assert re.search(rf"correspondences +{N}\n", case.text)
    assert re.search(rf"RMSE +{re.escape(rmse)}  \(weighted", case.text)
    assert f">{rmse}<" in card
    assert said["RMSE"].startswith(rmse)
    for entry in (*document["pose"]["quaternion_wxyz"], *document["pose"]["translation"]):
        assert repr(entry) in case.text
    percent = f"{100 * document['fit']['explained']:.12f}"[:4]
    assert percent in said["Explained"]
    assert re.search(rf"explained +{re.escape(percent)}", case.text)
    assert rows["translation ±"].startswith(shift)
    assert f"translation +/-   {shift}  (" in case.text
    assert rows["centre ±"].startswith(two_digits([uncertainty["centre"]]))
    assert shift in card
    ratio = f"{document['fit']['largest_over_median_residual']:.3g}"
    assert said["Worst pair"].startswith(f"{ratio} ×")
    assert ("Chi-squared" in said) == ("chi-squared" in case.text) == ("sigma" in case.noise)


def _add_column(path: Path, name: str, values: list[float]) -> None:
    lines = path.read_text("utf-8").splitlines()
    cells = [name, *map(repr, values)]
    path.write_text("".join(f"{a},{b}\n" for a, b in zip(lines, cells, strict=True)), "utf-8")


@pytest.mark.one_in(4)
def test_a_line_of_a_batch_and_its_table_hold_the_same_numbers(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(arrays, "BLOCK_POINTS", BLOCK)
    reference = case.reference
    labels = [f"P{k}" for k in range(N)]
    write_csv(tmp_path / "a.csv", reference.source.tolist(), labels)
    write_csv(tmp_path / "b.csv", reference.target[::-1].tolist(), labels[::-1])
    header, row = "source,target", "a.csv,b.csv"
    sigma: Any = case.noise.get("sigma")
    if np.ndim(sigma):
        _add_column(tmp_path / "a.csv", "sigma", np.asarray(sigma).tolist())
    elif sigma is not None:
        header, row = f"{header},sigma", f"{row},{sigma!r}"
    if "weights" in case.noise:
        (tmp_path / "w.txt").write_text(
            "\n".join(map(repr, case.noise["weights"].tolist())), "utf-8"
        )
        header, row = f"{header},weights", f"{row},w.txt"
    (tmp_path / "list.csv").write_text(f"{header}\n{row}\n", "utf-8")
    monkeypatch.setattr(pairs, "certify", partial(certify, relaxation=False, simulation=False))
    (line,) = read_listing(tmp_path / "list.csv").rows()
    entry, _ = pairs._entry(line, tmp_path, Limits())
    cells = pairs._row(json.loads(pairs._line(entry)))

    for key in ("n", "objective", "rmse", "pose", "fit", "optimality", "margin", "residuals"):
        assert entry[key] == case.document[key], key
    pose = case.document["pose"]
    numbers = [*pose["quaternion_wxyz"], *pose["translation"]]
    assert [cells[name] for name in pairs.POSE_COLUMNS] == numbers
    proved = case.document["optimality"]
    for name in ("gap_bound", "gap_share", "angle_bound_rad", "status"):
        assert cells[name] == proved[name]
    for name in ("explained", "best_scale"):
        assert cells[name] == case.document["fit"][name]
    assert (cells["n"], cells["rmse"], cells["warnings"]) == (N, case.document["rmse"], "")
    assert cells["margin"] == case.document["margin"]["relative"]
