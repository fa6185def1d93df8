"""Equilibria, motions and many problems at once: what each verb of the table gives of the zoo."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from laws.zoo import ALL, SQUARES, Placement, cells, curvature, energy, named, slope, weights_of

import certreg
from certreg.geometry.so3 import rotation_matrix
from certreg.problem.support import Loss, Verb, refusal
from certreg.results import PoseVerdict

if TYPE_CHECKING:
    from laws.zoo import Array, Specimen

METHODS = (Verb.SPECTRAL, Verb.HOMOTOPY)
INTEGRATORS = (Verb.MIDPOINT, Verb.SPLITTING, Verb.EULER)


def asked(verbs: tuple[Verb, ...], zoo: list[Specimen] = SQUARES) -> dict[str, Any]:
    """Every problem with every verb that the table has for it."""
    every = named(zoo, verb=verbs)
    cases = [
        case for case in every["argvalues"] if refusal(case.values[0].cell, case.values[1]) is None
    ]
    return {**every, "argvalues": cases}


def turn_of(component: Any) -> Array:
    """(3, 3): the rotation of an equilibrium of whatever body."""
    component = getattr(component, "component", component)
    return (component.pose if hasattr(component, "pose") else component).rotation


def at_rest(one: Specimen, rotation: Array, scale: float) -> Placement:
    """With the translation at which no force is left."""
    W, moved = one.matrices, scale * one.given.source @ rotation.T
    pull = np.einsum("kij,kj->i", W, one.given.target - moved)
    shift = np.zeros(3) if one.cell.rotation_only else np.linalg.solve(W.sum(axis=0), pull)
    return Placement(rotation, shift, scale)


@pytest.mark.parametrize(**asked(METHODS))
def test_at_every_listed_pose_no_force_is_left_and_the_index_is_that_of_the_curvature(
    one: Specimen, verb: Verb
):
    found: Any = certreg.equilibria(one.problem, verb.value)
    energies = list[float]()
    for component in found.components:
        at = at_rest(one, turn_of(component), getattr(component, "scale", 1.0))
        bent = curvature(one, at, slice(None))
        size = np.sqrt(np.abs(np.diag(bent)))
        index = int((np.linalg.eigvalsh(bent / np.outer(size, size)) < 0.0).sum())
        energies.append(energy(one, at))

        assert (
            np.abs(slope(one, at, slice(None)) / size).max() < 1e-6 * np.sqrt(energies[-1]) + 1e-9
        )
        assert index == getattr(component, "component", component).morse_index
    assert found.count == len(found.components)
    assert energies == sorted(energies)
    assert energies[0] == pytest.approx(one.result.objective, rel=1e-9)
    assert np.abs(turn_of(found.components[0]) - one.result.pose.rotation).max() < 1e-12
    assert sum((-1) ** k for k in indices(one, found)) == 0


def indices(one: Specimen, found: Any) -> list[int]:
    """Of all rotations, those inside out, too: their alternating sum is that of SO(3)."""
    if not one.cell.scaled:
        return [component.morse_index for component in found.components]
    return [component.morse_index for component in found.rigid.components]


@pytest.mark.parametrize(**asked(METHODS))
def test_listed_poses_are_judged_to_be_what_they_are(one: Specimen, verb: Verb):
    found: Any = certreg.equilibria(one.problem, verb.value)
    for k, component in enumerate(found.components):
        at = at_rest(one, turn_of(component), getattr(component, "scale", 1.0))
        scale = [at.scale] if one.cell.scaled else []
        judged = certreg.assess(one.result, (at.rotation, at.translation, *scale))

        best = judged.verdict is PoseVerdict.OPTIMAL
        assert best or judged.verdict is PoseVerdict.SPURIOUS_EQUILIBRIUM
        assert best == (k == 0)
        assert judged.nearest_index == getattr(component, "component", component).morse_index


SIZED = [one for one in ALL if one.name.split()[0] in {"tiny", "huge"}]


@pytest.mark.parametrize(**asked(INTEGRATORS, [*SQUARES, *SIZED]))
def test_the_body_comes_to_rest_at_a_listed_pose_and_loses_energy_on_its_way(
    one: Specimen, verb: Verb
):
    run: Any = certreg.simulate(one.problem, verb.value)
    method = next(each for each in METHODS if refusal(one.cell, each) is None)
    listed: Any = certreg.equilibria(one.problem, method.value)
    end = np.array(rotation_matrix(run.quaternion.tolist()))
    stable = [k for k in listed.components if getattr(k, "component", k).morse_index == 0]
    apart = [np.abs(turn_of(component) - end).max() for component in stable]

    assert run.at_rest
    assert min(apart) < 1e-2
    if len(stable) == 1:
        assert np.abs(one.result.pose.rotation - end).max() < 1e-2
    if one.cell.scaled:
        assert run.scales[-1] == pytest.approx(one.result.pose.scale, rel=1e-3)
    if verb is Verb.MIDPOINT and not run.escapes:
        energies = run.potential + run.kinetic
        assert (np.diff(energies) <= 1e-12 * np.abs(energies[:-1]) + 1e-12).all()


@pytest.mark.slow
def test_many_results_are_those_of_each():
    found: list[Any] = certreg.certify_many([one.problem for one in SQUARES])

    for one, many in zip(SQUARES, found, strict=True):
        assert many.certificate.body == one.result.certificate.body
        assert many.certificate.digest == one.problem.digest()
        assert (many.pose.as_matrix() == one.result.pose.as_matrix()).all()
        assert many.objective == one.result.objective


PLAIN = [one for one in SQUARES if not one.cell.scaled and not one.cell.rotation_only]


@pytest.mark.parametrize("weighed", [False, True])
def test_many_certificates_are_those_of_each(weighed: bool):  # noqa: FBT001
    zoo = [one for one in PLAIN if not one.cell.springs and "sigma" not in one.options]
    zoo = [one for one in zoo if ("weights" in one.options) is weighed]
    weights = np.array([one.options["weights"] for one in zoo]) if weighed else None
    clouds = [np.array([getattr(one.given, side) for one in zoo]) for side in ("source", "target")]
    found = certreg.certify_many(*clouds, weights=weights)

    for k, one in enumerate(zoo):
        certificate: Any = found[k]
        assert certificate.digest == one.problem.digest()
        assert certreg.verify(certificate, one.problem).proved
        assert np.abs(found.poses[k] - one.result.pose.as_matrix()).max() < 1e-13


@pytest.mark.parametrize(**named(PLAIN))
def test_many_equilibria_are_those_of_each(one: Specimen):
    clouds = np.array([one.given.source] * 2), np.array([one.given.target] * 2)
    listed: Any = certreg.equilibria(one.problem, "homotopy")
    count, found = len(listed.components), several(one, clouds)
    spread = 1e-12 * float(energy(one, at_rest(one, turn_of(listed.components[-1]), 1.0)))

    if one.cell.springs:
        assert found.counts.tolist() == [count, count]
    for k, component in enumerate(listed.components):
        at = at_rest(one, turn_of(component), 1.0)
        if one.cell.springs:
            assert found.energies[1, k] == pytest.approx(component.energy, abs=spread)
            assert found.indices[1, k] == component.morse_index
        else:
            assert found.rmse[1, k] == pytest.approx(component.rmse, rel=1e-9)
        assert found.translations[1, k] == pytest.approx(at.translation, abs=1e-9)
        turned = np.array(rotation_matrix(found.quaternions[1, k].tolist()))
        assert turned == pytest.approx(at.rotation, abs=1e-9)


def several(one: Specimen, clouds: Any) -> Any:
    if one.cell.springs:
        return certreg.solve_many_springs(*clouds, **one.options)
    return certreg.solve_many(*clouds, weights=weights_of(one.options, one.n))


def test_every_cell_of_squares_has_a_method_or_an_integrator():
    for cell in cells():
        if cell.loss is Loss.SQUARES:
            assert any(refusal(cell, verb) is None for verb in METHODS)
