"""From a problem to a registration: propose, prove, check, judge.

Whatever the pairs weigh, however the source may move and whatever the loss is, these four stages
follow each other. A `Prover` says what each is for some of the problems; registries of them, by
structure in `squares.py` and by loss in `certification.py`, say which it is.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from certreg.native.loops import Integrator
from certreg.registration.progress import logged
from certreg.results import Absent, Limits, Verdict

if TYPE_CHECKING:
    from certreg.dynamics.integrators import SimulationSettings
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.support import Cell

    Provers = tuple[Callable[[], "Prover[Any, Any, Any]"], ...]

Proposal = TypeVar("Proposal")
Proved = TypeVar("Proved")
Result = TypeVar("Result")

NOT_ASKED = Absent("not asked for")
USUAL_LIMITS = Limits()


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """What is asked of a registration, beside its problem.

    relaxation: whether it is taken, or its solver by CVXPY's name. simulation: whether there is
    one, or its integrator. settings: further ones of it. robustness_angle: degrees; None to leave
    it out. limits: within which the pose is called certified. effort: a factor on the budgets of a
    search for wrong pairs. about: what else the certificate is to hold. not_taken: why relaxation
    or simulation is left out.
    """

    relaxation: bool | str = False
    simulation: bool | Integrator = False
    settings: SimulationSettings | None = None
    robustness_angle: float | None = None
    limits: Limits = USUAL_LIMITS
    effort: float = 1.0
    about: dict[str, Any] = field(default_factory=dict[str, Any])
    not_taken: Absent = NOT_ASKED

    @property
    def solver(self) -> str | None:
        """Of the relaxation, where one is named."""
        return self.relaxation if isinstance(self.relaxation, str) else None

    def integrator(self, usual: Integrator) -> Integrator | None:
        """Of the simulation; None for no simulation."""
        if isinstance(self.simulation, Integrator):
            return self.simulation
        return usual if self.simulation else None


USUAL = Asked()


class Work:
    """How far a registration is: which parts are done, and how long each phase took."""

    def __init__(self, done: Callable[[str], None] = logged) -> None:
        self.done = done
        self.timings: dict[str, float] = {}
        self._start = time.perf_counter()

    def lap(self, phase: str) -> None:
        """A phase is over: its seconds are those since the last one was."""
        now = time.perf_counter()
        self.timings[phase], self._start = now - self._start, now


class Prover(ABC, Generic[Proposal, Proved, Result]):
    """One way from a problem to its registration; it accepts some of the declared problems."""

    PARTS: ClassVar[int]  # told to `progress`, besides relaxation and simulation

    def accepts(self, cell: Cell) -> bool:
        """Whether this is the way for such problems: for all, unless there are several."""
        del cell
        return True

    def parts(self, asked: Asked) -> int:
        """So many parts are told as they are done."""
        del asked
        return self.PARTS

    @abstractmethod
    def propose(self, problem: RegistrationProblem, asked: Asked, work: Work) -> Proposal:
        """What is sought, found in doubles or exactly, and not yet proved."""

    @abstractmethod
    def prove(
        self, problem: RegistrationProblem, proposal: Proposal, asked: Asked, work: Work
    ) -> Proved:
        """What was found with its certificate, where it could be proved."""

    @abstractmethod
    def check(self, proved: Proved, work: Work) -> Verdict | None:
        """The checker's answer; None where there is no certificate. Raises where it refuses."""

    @abstractmethod
    def judge(
        self, proved: Proved, verdict: Verdict | None, asked: Asked, timings: dict[str, float]
    ) -> Result:
        """The registration: what was found, and what it is worth by what was accepted."""

    def certified(self, problem: RegistrationProblem, asked: Asked, work: Work) -> Result:
        """All four stages."""
        proposal = self.propose(problem, asked, work)
        proved = self.prove(problem, proposal, asked, work)
        verdict = self.check(proved, work)
        return self.judge(proved, verdict, asked, work.timings)


def accepting(provers: Provers, cell: Cell) -> Prover[Any, Any, Any]:
    """The first that accepts a declared problem; those after it are not loaded."""
    return next(prover for load in provers if (prover := load()).accepts(cell))
