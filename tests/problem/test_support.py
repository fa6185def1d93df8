"""The table of what is supported, held against what happens: every cell, every verb."""

from __future__ import annotations

import ast
import itertools
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from syntax import nodes

import certreg
from certreg.errors import InvalidProblemError
from certreg.problem.motion import Motion, Scale, checked_motion
from certreg.problem.support import TABLE, Cell, Loss, Verb, refusal, supported

if TYPE_CHECKING:
    from collections.abc import Callable

PAIRS = 12
RNG = np.random.default_rng(40)
SOURCE = RNG.normal(size=(PAIRS, 3))
TURN = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
TURN = TURN * np.linalg.det(TURN)
NOISE = 0.01 * RNG.normal(size=(PAIRS, 3))
AXES = RNG.normal(size=(PAIRS, 3))
AXES /= np.linalg.norm(AXES, axis=1)[:, None]
SHAPES = RNG.normal(size=(PAIRS, 3, 3))
DATA: dict[str, dict[str, Any]] = {
    "weights": {},
    "planes": {"normals": AXES},
    "lines": {"directions": AXES},
    "covariances": {"covariances": SHAPES @ SHAPES.transpose(0, 2, 1) + np.eye(3)},
}
MOTIONS: dict[str, dict[str, Any]] = {
    "pose": {},
    "rotation": {"rotation_only": True},
    "asymmetric": {"scale": "asymmetric"},
    "symmetric": {"scale": "symmetric"},
    "asymmetric rotation": {"scale": "asymmetric", "rotation_only": True},
}
LOSSES: dict[Loss, dict[str, Any]] = {
    Loss.SQUARES: {},
    Loss.CONSENSUS: {"max_residual": 0.3},
    Loss.TRUNCATED: {"max_residual": 0.3, "objective": "truncated"},
}
ACCEPTED = 18  # of 60; a cell that opens, or closes, changes this number knowingly
CELLS = list(itertools.product(DATA, MOTIONS, LOSSES))


def motion_of(motion: str) -> Motion:
    moves = MOTIONS[motion]
    return checked_motion(moves.get("scale", "none"), moves.get("rotation_only", False))


def cell_of(data: str, motion: str, loss: Loss) -> Cell:
    """What the cell declares."""
    moves = MOTIONS[motion]
    return Cell(
        springs=data != "weights",
        scale=Scale(moves.get("scale", "none")),
        rotation_only=moves.get("rotation_only", False),
        loss=loss,
    )


def options_of(cell: Cell, data: str) -> dict[str, Any]:
    """What a user gives for the cell."""
    return {
        **(DATA[data] if cell.springs else {}),
        "scale": cell.scale,
        "rotation_only": cell.rotation_only,
        **LOSSES[cell.loss],
    }


def target_of(cell: Cell) -> Any:
    """Points that such a motion meets."""
    shift = 0.0 if cell.rotation_only else np.array([1.0, 2.0, 3.0])
    return SOURCE @ TURN.T + NOISE + shift


def certified(cell: Cell, data: str) -> Any:
    """The result of `certify` on points of the cell."""
    return certreg.certify(SOURCE, target_of(cell), **options_of(cell, data))


def refused_sentence(call: Callable[[], object]) -> str:
    """Of the error that the call ends with."""
    with pytest.raises(InvalidProblemError) as caught:
        call()
    return str(caught.value)


def test_the_table_accepts_as_many_cells_as_documented() -> None:
    assert len(CELLS) == 60
    assert sum(supported(cell_of(*key)) for key in CELLS) == ACCEPTED


@pytest.mark.slow
@pytest.mark.parametrize(("data", "motion", "loss"), CELLS)
def test_a_cell_is_certified_and_verified_or_refused_with_remedies_that_work(
    data: str, motion: str, loss: Loss, tmp_path: Any
) -> None:
    cell = cell_of(data, motion, loss)
    refused = refusal(cell)
    if refused is None:
        result = certified(cell, data)
        assert certreg.verify(result.certificate).proved
        assert result.to_dict()["pose"]["rotation"] is not None
        result.report(tmp_path / "report.html")
        assert (tmp_path / "report.html").stat().st_size > 0
        return
    assert refused_sentence(lambda: certified(cell, data)) == refused.sentence
    assert refused.remedies
    for remedy in refused.remedies:
        assert refused.sentence.count(remedy.words) == 1
        assert certreg.verify(certified(remedy.cell, data).certificate).proved


SQUARES = [(data, motion) for data, motion, loss in CELLS if loss is Loss.SQUARES]
VERBS: dict[Verb, Callable[[certreg.RegistrationProblem], object]] = {
    **{
        verb: lambda problem, verb=verb: certreg.equilibria(problem, verb.value)
        for verb in (Verb.SPECTRAL, Verb.HOMOTOPY)
    },
    **{
        verb: lambda problem, verb=verb: certreg.simulate(problem, verb.value)
        for verb in (Verb.MIDPOINT, Verb.SPLITTING, Verb.EULER)
    },
}


@pytest.mark.slow
@pytest.mark.parametrize(("data", "motion"), SQUARES)
def test_every_verb_answers_or_refuses_by_the_table(data: str, motion: str) -> None:
    cell = cell_of(data, motion, Loss.SQUARES)
    options = options_of(cell, data)
    if not supported(cell):
        sentence = refusal(cell).sentence  # type: ignore[union-attr]
        target = target_of(cell)
        assert refused_sentence(lambda: certreg.register(SOURCE, target, **options)) == sentence
        return
    target = target_of(cell)
    certreg.register(SOURCE, target, **options)
    problem = certreg.RegistrationProblem(SOURCE, target, **options)
    certreg.assess(problem, TURN, np.zeros(3))
    for verb, call in VERBS.items():
        refused = refusal(cell, verb)
        if refused is None:
            assert call(problem) is not None
            continue
        assert refused_sentence(lambda call=call: call(problem)) == refused.sentence
        for remedy in refused.remedies:
            other = certreg.RegistrationProblem(SOURCE, target, **options_of(remedy.cell, data))
            assert VERBS[remedy.verb](other) is not None


@pytest.mark.parametrize("verb", Verb)
def test_every_refusal_names_a_remedy_that_the_table_supports(verb: Verb) -> None:
    for data, motion in SQUARES:
        cell = cell_of(data, motion, Loss.SQUARES)
        if not supported(cell) or (refused := refusal(cell, verb)) is None:
            continue
        assert refused.remedies
        assert all(supported(one.cell, one.verb) for one in refused.remedies)


def test_no_rule_of_the_table_is_without_a_case() -> None:
    for rule in TABLE:
        verbs = rule.verbs or {Verb.CERTIFY}
        assert any(
            rule.applies(cell_of(*key)) and refusal(cell_of(*key), verb).reason == rule.reason  # type: ignore[union-attr]
            for key in [*CELLS, *itertools.product(DATA, MOTIONS, [Loss.BREAKING])]
            for verb in verbs
        )


@pytest.mark.slow
@pytest.mark.parametrize(("data", "motion"), SQUARES)
def test_parameters_are_counted_in_one_place(
    data: str, motion: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One parameter more, and every number of degrees of freedom follows."""
    cell = cell_of(data, motion, Loss.SQUARES)
    if not supported(cell):
        return
    options = options_of(cell, data)
    told: list[dict[str, Any]] = []
    for more in (0, 1):
        count = {one: one.parameters + more for one in (motion_of(motion),)}
        monkeypatch.setattr(Motion, "parameters", property(count.get))
        result = certreg.certify(SOURCE, target_of(cell), **options)
        noisy = certreg.certify(SOURCE, target_of(cell), sigma=0.01, **options)
        document = result.to_dict()
        told.append(
            {
                "degrees": result.degrees_of_freedom,
                "variance": float(np.trace(document["pose"]["covariance"] or [[0.0]])),
                "chi2": (noisy.to_dict()["fit"]["chi2"] or {"dof": None, "p": None}),
            }
        )
        monkeypatch.undo()
    one, two = told
    assert two["degrees"] == one["degrees"] - 1
    asymmetric = cell.scale is not Scale.SYMMETRIC  # of the other neither is computed
    assert (one["variance"] != two["variance"]) is (asymmetric and data != "covariances")
    assert (one["chi2"] != two["chi2"]) is asymmetric


FITTED = [key for key in CELLS if supported(cell_of(*key)) and key[2] is not Loss.TRUNCATED]
FORMS = {"covariances": {"information": DATA["covariances"]["covariances"]}}  # that say no noise


def told(data: str, motion: str, loss: Loss, *, noise: bool) -> dict[str, Any]:
    """What rests on the number of parameters, of a fit; noise: whether its size is given."""
    cell = cell_of(data, motion, loss)
    options = options_of(cell, data)
    if noise and data != "covariances":
        options["sigma"] = 0.01
    elif not noise and data in FORMS:
        options = {**options, **FORMS[data]}
        del options["covariances"]
    result: Any = certreg.certify(SOURCE, target_of(cell), **options)
    fitted = result if loss is Loss.SQUARES else result.fit
    found: dict[str, Any] = {"degrees": fitted.degrees_of_freedom}
    if cell.scale is Scale.SYMMETRIC:  # without a covariance and a test, as noise shifts it
        return found
    document = {name: part for name, part in result.to_dict().items() if name != "timings_ms"}
    found["document"] = str(document)
    if noise:
        return {**found, "chi2": (fitted.fit.chi2.dof, fitted.fit.chi2.p)}
    covariance = fitted.covariance
    sigmas = covariance.rotation_sigma, covariance.translation_sigma
    return {**found, "+-": str(sigmas), "matrix": str(covariance.matrix)}


@pytest.mark.slow
@pytest.mark.parametrize(("data", "motion", "loss"), FITTED)
@pytest.mark.parametrize("noise", [False, True])
def test_parameters_are_counted_by_the_motion_alone(
    data: str, motion: str, loss: Loss, *, noise: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One more changes degrees of freedom, +-, chi-squared, covariance and JSON in every cell.

    But of truncated squares, of which no fit is told.
    """
    right = told(data, motion, loss, noise=noise)
    assert told(data, motion, loss, noise=noise) == right
    count: Any = Motion.parameters
    monkeypatch.setattr(Motion, "parameters", property(lambda self: count.fget(self) + 1))
    wrong = told(data, motion, loss, noise=noise)

    assert right.keys() == wrong.keys()
    assert [name for name in right if right[name] == wrong[name]] == []
    assert right["degrees"] == wrong["degrees"] + 1


def test_nobody_else_subtracts_parameters() -> None:
    """No 3 n - 6 and no 3 n - 7: what is left of observations is said by the motion."""
    package = Path(certreg.__file__).parent
    wings = ("problem", "registration", "report")
    files = [file for wing in wings for file in (package / wing).glob("*.py")]
    found = [
        f"{file.name}: {ast.unparse(node)}"
        for file in files
        if file.name != "motion.py"
        for node in nodes(file.read_text("utf-8"))
        if isinstance(node, ast.BinOp)
        and isinstance(node.op, ast.Sub)
        and re.search(r"^[67]$|\bparameters$", ast.unparse(node.right))
    ]

    assert len(files) > 100
    assert found == []
