"""Where the time goes: each phase of `solve`, and the check, for several numbers of points."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from benchmarks.clouds import random_problem
from benchmarks.measuring import Figure, Quantity, fastest
from certreg.certificate.isotropic import produce
from certreg.equilibrium.critical_set import by_eigenspaces
from certreg.equilibrium.equilibrium_set import equilibrium_set
from certreg.exact.eigenbasis import integer_eigenbasis
from certreg.objective.classification import classify
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments, floating_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration.squares import solve
from certreg.verify import check

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from certreg.equilibrium.equilibrium_set import EquilibriumSet


SIZES = (10, 100, 1000, 100_000)
ROUNDS = 3


def measure() -> Iterator[Figure]:
    phases = [_phases(random_problem(n)) for n in SIZES]
    times = [fastest(*each.values(), rounds=ROUNDS) for each in phases]
    for name, row in zip(phases[0], zip(*times, strict=True), strict=True):
        entries = zip(SIZES, row, strict=True)
        yield Figure(what=name, beside={f"N = {n}:": Quantity(t, "s") for n, t in entries})


def _phases(problem: RegistrationProblem) -> dict[str, Callable[[], object]]:
    moments = exact_moments(problem)
    found = Isotropic(moments)
    certificate = produce(problem, found)
    assert certificate is not None
    content = certificate.to_json()

    def fresh() -> Isotropic:
        """Without what an objective and its moments remember once it was computed."""
        return Isotropic(replace(moments))

    x, y, w = problem.source, problem.target, problem.weights
    return {
        "problem": lambda: RegistrationProblem(x, y, weights=w),
        "exact moments": lambda: exact_moments(problem),
        "floating moments": lambda: floating_moments(problem),
        "classification": lambda: classify(moments),
        "eigenbasis": lambda: integer_eigenbasis(found.davenport, found.eigenspaces.bits),
        "equilibria, stability": lambda: _equilibria(fresh(), problem.damping),
        "certificate": lambda: produce(problem, fresh()),
        "solve, all of these": lambda: solve(problem),
        "check": lambda: check(content),
    }


def _equilibria(objective: Isotropic, damping: float) -> EquilibriumSet:
    return equilibrium_set(by_eigenspaces(objective), objective, damping)
