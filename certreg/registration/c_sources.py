"""The generated C for other people's programs: two files, an example, and data to run it on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.dynamics.integrators import EULER_STEP, SimulationSettings
from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.states import start_at_rest
from certreg.errors import InvalidFileError
from certreg.io.atomic import remedy_of, write_atomically
from certreg.native.codegen.emit import C_FILE, HEADER_FILE
from certreg.native.kernels import GENERATED, HERE
from certreg.problem.moments import exact_moments
from certreg.registration.examples import STORIES, stated

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.problem.problem import RegistrationProblem

EXAMPLE_FILE, DATA_FILE = "example.c", "survey.txt"


def write_sources(folder: Path) -> list[Path]:
    """Write dynamics.c, dynamics.h, example.c and survey.txt to a folder; the paths written.

    Raises InvalidFileError where the folder cannot be made or written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidFileError(
            f"{folder}: cannot be made a folder ({error.strerror}): {remedy_of(error)}", path=folder
        ) from error
    contents = {
        C_FILE: (GENERATED / C_FILE).read_bytes(),
        HEADER_FILE: (GENERATED / HEADER_FILE).read_bytes(),
        EXAMPLE_FILE: (HERE / EXAMPLE_FILE).read_bytes(),
        DATA_FILE: example_input(stated(STORIES[0])).encode(),
    }
    for name, content in contents.items():
        write_atomically(folder / name, content)
    return [folder / name for name in contents]


def example_input(problem: RegistrationProblem) -> str:
    """What example.c reads, one number a line: body, start at rest, step, tolerance, most steps."""
    settings = SimulationSettings()
    moments = exact_moments(problem)
    moving = rigid_body(moments, problem.damping)
    start = start_at_rest(moments, moving.length_exponent)
    control = [EULER_STEP, settings.speed_tolerance, float(settings.max_steps)]
    numbers = [*moving.parameters.tolist(), *start.tolist(), *control]
    return "".join(f"{number!r}\n" for number in numbers)
