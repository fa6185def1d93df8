"""The demo: three real registration problems, what is known of each, and whether it came out so."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import as_file, files
from typing import TYPE_CHECKING

from certreg.io.problems import read_problem
from certreg.registration.certification import certify
from certreg.results import Optimality

if TYPE_CHECKING:
    from certreg.io.pairing import Pair
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.result import Registration


RMSE_DIGITS = 6  # as the figures below are printed


@dataclass(frozen=True, slots=True, kw_only=True)
class Story:
    """A packaged problem: its files, the RMSE of its four equilibria, and what it tells."""

    name: str
    title: str
    source: str
    target: str
    told_rmse: tuple[float, ...]
    told: str


STORIES = (
    Story(
        name="survey",
        title="Survey: four reference points, mm",
        source="survey_source.csv",
        target="survey_target.csv",
        told_rmse=(5.838987, 719.674350, 2284.899842, 2395.550956),
        told=(
            "Aligned with a well-known tool, these four points came out 'totally flipped', as its\n"
            "developer put it, with an RMS of 2395.55 (CloudCompare, issue 498). That pose is no\n"
            "accident: it is the index-3 equilibrium below, where all forces and torques balance,\n"
            "and which is the worst rotation there is. The optimum has an RMSE of 5.84."
        ),
    ),
    Story(
        name="head",
        title="Head: 338 electrode positions on two head models, mm",
        source="head_colin27.csv",
        target="head_fsaverage.csv",
        told_rmse=(4.533814, 137.047215, 157.314223, 174.541110),
        told="Points are paired by their label. The optimum is proved, not just found.",
    ),
    Story(
        name="abeta",
        title="Amyloid-beta fibril: 130 C-alpha atoms, models 1 and 2 of PDB 2BEG, angstrom",
        source="abeta_2beg_model01.csv",
        target="abeta_2beg_model02.csv",
        told_rmse=(1.483978, 16.990655, 25.524941, 27.351661),
        told="Superposition of two NMR models, and the three ways in which it can go wrong.",
    ),
)


def stated(story: Story) -> RegistrationProblem:
    """A packaged problem."""
    return _read(story)[0]


def tell(story: Story) -> Registration:
    """The certified registration of a packaged problem."""
    problem, pair = _read(story)
    return certify(problem, about=pair.about)


def _read(story: Story) -> tuple[RegistrationProblem, Pair]:
    folder = files("certreg") / "data"
    with as_file(folder / story.source) as source, as_file(folder / story.target) as target:
        return read_problem(source, target)


def differences(story: Story, registration: Registration) -> Iterator[str]:
    """In words, where a registration did not come out as told; nothing if all is well."""
    if registration.status is not Optimality.CERTIFIED:
        yield f"status is {registration.status.value}, told: certified"
    components = registration.equilibria.components
    rmse = tuple(round(c.rmse or 0.0, RMSE_DIGITS) for c in components)
    if rmse != story.told_rmse:
        yield f"RMSE of the equilibria are {rmse}, told: {story.told_rmse}"
    for component, index in zip(components, range(4), strict=False):
        if component.morse_index != index or component.unstable_eigenvalues != index:
            yield f"equilibrium {index} has Morse index {component.morse_index}"
