"""The semidefinite relaxation beside the truth: value, rank, proved gap; how long a solve takes.

The bound is on the worst proved gap over the spread of both clouds. Percentages are of solves whose
raw number, taken for an upper bound, would have been wrong; errors are relative to C. Ranks are of
the optimal Z, and how often each was found.
"""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.clouds import random_problem
from benchmarks.measuring import Figure, Quantity, fastest
from certreg.certificate.isotropic import multiplier_gap, proved_multiplier
from certreg.objective.isotropic import Isotropic
from certreg.problem.lifting import lift
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.relaxation.conic import solve
from certreg.relaxation.cvxpy_models import statement
from certreg.relaxation.qcqp import RelaxationForm
from certreg.relaxation.shor import relax
from tests.strategies import ZOO, Specimen

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


GAP_BOUND = 1e-6  # of the spread
SOLVE_BOUNDS = {RelaxationForm.QUATERNION: 1.5e-3, RelaxationForm.ROTATION: 3e-3}  # seconds
ROUNDS = 20
SEEDS = range(100)
SIZES = (3, 4, 10, 100)
FAMILIES = {
    "no noise": {"noise": 0.0},
    "noise 0.01": {"noise": 0.01},
    "noise 1": {"noise": 1.0},
    "noise 10": {"noise": 10.0},
    "offset 1e8": {"offset": 1e8},
    "scale 1e-170": {"scale": 1e-170, "noise": 0.1},
    "scale 1e150": {"scale": 1e150, "noise": 0.1},
}
NEARLY = next(specimen for specimen in ZOO if specimen.name == "mirrored tall")
IMPORT = "import time; t = time.perf_counter(); import cvxpy; print(time.perf_counter() - t)"
COMPILE = (
    "import time, numpy; from certreg.relaxation.conic import solve; "
    "from certreg.relaxation.qcqp import RelaxationForm; "
    "t = time.perf_counter(); solve(RelaxationForm({!r}), numpy.eye(3)); "
    "print(time.perf_counter() - t)"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What the relaxation made of one problem; `ranks` and `errors` by form."""

    unique: bool
    ranks: dict[RelaxationForm, int]
    errors: dict[RelaxationForm, float]
    value_below: bool
    multiplier_below: bool
    gap: float


def measure() -> Iterator[Figure]:
    outcomes = {name: [_outcome(problem) for problem in row] for name, row in _problems().items()}
    for name, row in outcomes.items():
        yield _tightness(name, row)
    everything = list(chain.from_iterable(outcomes.values()))
    yield _tightness("all", everything)
    for form in RelaxationForm:
        yield _ranks("unique", [each for each in everything if each.unique], form)
        yield _ranks("nearly ambiguous", outcomes["nearly ambiguous"], form)
        yield _ranks("not unique", [each for each in everything if not each.unique], form)
    for form, bound in SOLVE_BOUNDS.items():
        yield _speed(form, bound)
    compiling = {
        f"compile {form}": Quantity(_told(COMPILE.format(form.value)), "s")
        for form in RelaxationForm
    }
    yield Figure(
        what="once per process",
        beside={"import cvxpy": Quantity(_told(IMPORT), "s"), **compiling},
    )


def _problems() -> dict[str, list[RegistrationProblem]]:
    families = {
        name: [random_problem(SIZES[s % len(SIZES)], seed=s, **options) for s in SEEDS]
        for name, options in FAMILIES.items()
    }
    return families | {
        "reflected": [_reflected(random_problem(20, seed=s, noise=0.1)) for s in SEEDS],
        "planar": [_flattened(random_problem(20, seed=s, noise=0.1)) for s in SEEDS],
        "nearly ambiguous": [_shaken(NEARLY, s, 10.0 ** -(1 + s % 12)) for s in SEEDS],
        "degenerate": [_resized(each, 10 * k) for each in ZOO for k in range(-2, 3)],
    }


def _reflected(problem: RegistrationProblem) -> RegistrationProblem:
    return RegistrationProblem(problem.source * [1, 1, -1], problem.target, weights=problem.weights)


def _flattened(problem: RegistrationProblem) -> RegistrationProblem:
    return RegistrationProblem(problem.source * [1, 1, 0], problem.target, weights=problem.weights)


def _shaken(specimen: Specimen, seed: int, noise: float) -> RegistrationProblem:
    shaking = noise * np.random.default_rng(seed).normal(size=np.shape(specimen.target))
    return RegistrationProblem(specimen.source, np.array(specimen.target) + shaking)


def _resized(specimen: Specimen, exponent: int) -> RegistrationProblem:
    factor = 2.0**exponent
    return RegistrationProblem(np.array(specimen.source) * factor, specimen.target)


def _outcome(problem: RegistrationProblem) -> Outcome:
    objective = Isotropic(exact_moments(problem))
    largest = objective.eigenvalues[0]
    answers = {form: relax(objective, form) for form in RelaxationForm}
    ours = answers[RelaxationForm.QUATERNION]
    assert ours.proposal is not None
    assert ours.value is not None
    return Outcome(
        unique=objective.classification.unique,
        ranks={form: answer.rank or 0 for form, answer in answers.items()},
        errors={
            form: abs(float(Fraction(answer.value or 0.0) - largest / answer.unit))
            for form, answer in answers.items()
        },
        value_below=Fraction(ours.value) * ours.unit < largest,
        multiplier_below=ours.proposal < largest,
        gap=_gap(objective, ours.proposal, ours.quaternion_wxyz),
    )


def _gap(objective: Isotropic, proposal: Fraction, quaternion: object) -> float:
    """Proved, over the spread; infinite where nothing was proved."""
    nu = proved_multiplier(objective, proposal)
    if nu is None:
        return np.inf
    gap = multiplier_gap(objective, lift(np.asarray(quaternion)).integers, nu)
    moments = objective.moments
    return float(gap / (moments.spread or moments.cross_unit))


def _tightness(name: str, row: list[Outcome]) -> Figure:
    return Figure(
        what=name,
        value=Quantity(_short(max(outcome.gap for outcome in row)), ""),
        bound=GAP_BOUND,
        beside={
            "of": Quantity(len(row), "problems"),
            "value < truth": Quantity(_percent(o.value_below for o in row), "%"),
            "multiplier < truth": Quantity(_percent(o.multiplier_below for o in row), "%"),
            **{
                f"error {form}": Quantity(_short(max(o.errors[form] for o in row)), "")
                for form in RelaxationForm
            },
        },
    )


def _ranks(name: str, row: list[Outcome], form: RelaxationForm) -> Figure:
    ranks = Counter(outcome.ranks[form] for outcome in row)
    return Figure(
        what=f"ranks, {name}",
        beside={f"{form}:": Quantity(len(row), "problems")}
        | {f"rank {rank}:": Quantity(count, "") for rank, count in sorted(ranks.items())},
    )


def _short(value: float) -> float:
    return float(f"{value:.1e}")


def _percent(cases: Iterable[bool]) -> float:
    return round(100 * float(np.mean(list(cases))))


def _speed(form: RelaxationForm, bound: float) -> Figure:
    C = np.random.default_rng(0).normal(size=(3, 3))
    C /= np.abs(C).max()
    stated = statement(form)

    def by_cvxpy() -> float:
        stated.data.value = C
        return stated.problem.solve(solver="CLARABEL")

    def fresh() -> float:
        anew = statement(form)
        anew.data.value = C
        return anew.problem.solve(solver="CLARABEL")

    value = solve(form, C, largest=True).value
    assert value is not None
    assert abs(value - by_cvxpy()) < 1e-7
    times = fastest(lambda: solve(form, C), by_cvxpy, fresh, rounds=ROUNDS)
    again, plain, first = (Quantity(seconds, "s") for seconds in times)
    return Figure(
        what=f"solve {form}",
        value=again,
        bound=bound,
        beside={"CVXPY, stated once": plain, "CVXPY, stated anew": first},
    )


def _told(code: str) -> float:
    """The number that a fresh process prints."""
    done = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, encoding="utf-8"
    )
    return float(done.stdout)
