"""The equilibria of general springs, and of a free scale, as they are handed to the user.

With the asymmetric scale the size of the body is a state, and the equilibria are the eigenlines
with a positive eigenvalue. The symmetric scale is the same whatever the rotation: a body of that
size is rigid, and has the equilibria of the rigid body. Those of one weight per pair and scale 1
are an `EquilibriumSet`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import late
from certreg.dynamics.simulation import simulate
from certreg.dynamics.valleys import spring_body
from certreg.equilibrium.breathing import BreathingEquilibria, breathing_equilibria
from certreg.equilibrium.equilibrium_set import Component, EquilibriumSet, unit_double
from certreg.equilibrium.line_set import Finiteness, LineSet
from certreg.equilibrium.methods import FINDERS, search
from certreg.errors import DegenerateProblemError
from certreg.exact.dyadic import nearest_double, nearest_root
from certreg.geometry.so3 import canonical, dot, squared_norm
from certreg.native.kernels import MissingLibraryError
from certreg.objective.springs import Springs
from certreg.registration.curvature import slope_and_curvature, soft_axes
from certreg.registration.exit_codes import code_of_list
from certreg.registration.loose_turns import axis_words
from certreg.registration.optimum import pose_at
from certreg.registration.outlying import LISTED
from certreg.registration.unobservable import Freedom
from certreg.registration.weakly_constrained import weak_shift_words, weak_shifts
from certreg.registration.whitened_residuals import ResidualSums
from certreg.results import OUT_OF_RANGE, Absent, ComponentKind, Explained, Guarantee, Presented

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.geometry.pose import Pose
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.problem import RegistrationProblem
    from certreg.relaxation import optimum
else:
    optimum = late("certreg.relaxation.optimum")


LINES = 40
SAME_ENERGY = Fraction(1, 1 << 90)  # of the oscillation
RELEASED = math.radians(1.0)  # from the equilibrium: far above what runs end within
RETURNED = math.radians(0.1)  # to it: ten times what a run that ends is off
KNOWN = Fraction(1, 1 << 300)  # of the oscillation: to this the energy of a proved one is known
NOT_SEPARATED = Absent("not proved to be one equilibrium: it may be several, or none")
TIED = Absent("as good as another equilibrium, as far as 300 digits tell")
DEEPEST = Absent("the energy falls in no direction")
BEST_UNKNOWN = Absent("which equilibrium is the optimum is not decided")
ALL_RESISTED = Absent("no shift or turn is known to be left open, or hardly resisted")
CONTINUUM = Absent("the equilibria form a continuum: there are infinitely many")
NOT_LISTED_WHOLE = Absent("the list is not proved complete: a better rotation may be missing")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringEquilibrium(Explained):
    """A rotation at which general springs balance, with its best translation.

    separated: proved to be one equilibrium, alone in a box; else paths only ended there, and it may
        be one, several, or none.
    morse_index: of a separated one, proved: the number of directions in which the energy falls.
    optimal: whether it is the best pose; None where that is not decided. One of which the index is
        not 0 is no minimum.
    witness: (3,), unit, in the source's frame: turning about it lowers the energy most.
    basis: (4, 1), the unit quaternion; (4, 4) where every rotation is an equilibrium.
    energy: 0 where it is less than 2^-300 of the range of energies, to which it is known.
    above: the energy less the least of the list.
    angle_to_first: radians, to the first of the list.
    angle_to_optimum: the same where the first is proved to be the optimum, or one of several that
        are; None where that is not decided.
    """

    kind: ComponentKind
    separated: bool
    morse_index: int | None
    optimal: bool | None
    witness: NDArray[np.float64] | None
    energy: float | None
    above: float | None
    rmse: float | None
    pose: Pose
    basis: NDArray[np.float64]
    angle_to_first: float
    angle_to_optimum: float | None

    @property
    def stable(self) -> bool | None:
        """Whether it is a strict minimum of the energy over rotations; None: not decided."""
        return None if self.morse_index is None else self.morse_index == 0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringEquilibria(Explained, Presented):
    """The equilibria of general springs, by ascending energy.

    Attributes
    ----------
    components
        Those that are listed.
    complete
        Whether these are proved to be all.
    doubt
        Why they may not be; None where they are.
    guarantee
        Of the least sure component.
    finiteness
        What is proved of the number of critical lines, complex ones included.
    pairs
        Of conjugate lines, no rotations, that were proved to be apart.
    tied
        How many of the first may be the best; 0 where that is not decided.
    undetermined
        In words, the shifts and turns that the springs leave open, or hardly resist; None where no
        such one is known.
    relative_margin
        (E2 - E1) / (Emax - E1) of the two best energies; None where the best is not known.
    enumeration
        The searches for them, an `Enumeration`; None beside a registration.
    """

    components: tuple[SpringEquilibrium, ...]
    complete: bool
    doubt: str | None
    guarantee: Guarantee
    finiteness: Finiteness
    pairs: int
    tied: int
    undetermined: str | None
    relative_margin: float | None
    enumeration: Any = None

    def __repr__(self) -> str:
        known = "complete" if self.complete else "not proved complete"
        stable = "" if self.stable is None else f", {self.stable} stable"
        count = sum(part.separated for part in self.components)
        return f"<SpringEquilibria: {count}{stable}; {self.guarantee.label}, {known}>"

    @property
    def count(self) -> int | None:
        """How many equilibria there are; None where that is not proved, or infinitely many."""
        alone = all(part.kind is ComponentKind.POINT for part in self.components)
        return len(self.components) if self.complete and alone else None

    @property
    def count_complex(self) -> int | None:
        """40 where all critical lines, complex ones included, are proved to be simple."""
        whole = self.count is not None and self.finiteness is Finiteness.FORTY
        return LINES if whole else None

    @property
    def stable(self) -> int | None:
        """How many are stable; None where the list is not complete."""
        return sum(bool(part.stable) for part in self.components) if self.complete else None

    @property
    def unique(self) -> bool:
        """Whether one rotation is proved to be the best. False means not proved."""
        return self.tied == 1 and self.count is not None

    @property
    def all_optimal(self) -> bool:
        """Whether every rotation is proved to be the best."""
        return self.complete and self.finiteness is Finiteness.CONSTANT

    @property
    def exit_code(self) -> int:
        """What `equilibria` ends with: 0; 3 where every rotation is optimal; 4 for less."""
        return code_of_list(unique=False if self.all_optimal else self.unique or None)

    @property
    def euler_sum(self) -> int | None:
        """The sum of (-1)^index, which is 0 where all are listed and none is degenerate."""
        indices = [part.morse_index for part in self.components]
        if self.count is None or None in indices:
            return None
        return sum(-1 if index % 2 else 1 for index in indices if index is not None)


def spring_equilibria(
    critical: LineSet, objective: Springs, problem: RegistrationProblem
) -> SpringEquilibria:
    """The equilibria at the critical rotations of an objective."""
    poses = [pose_at(objective, part.quaternion) for part in critical.components]
    stiffness = ResidualSums.of(problem, poses[0], LISTED).stiffness if poses else 0.0
    parts = tuple(
        _equilibrium(critical, place, pose, objective, stiffness)
        for place, pose in enumerate(poses)
    )
    return SpringEquilibria(
        components=parts,
        complete=critical.complete,
        doubt=critical.doubt,
        guarantee=min((p.guarantee for p in critical.components), default=Guarantee.NUMERICAL),
        finiteness=critical.finiteness,
        pairs=critical.pairs,
        tied=critical.tied,
        undetermined=_open_words(objective) or None,
        relative_margin=_margin(critical),
        absent={**_reasons(critical), "undetermined": ALL_RESISTED},
    )


def _reasons(critical: LineSet) -> dict[str, Absent]:
    doubt = Absent(critical.doubt or critical.finiteness.value)
    return dict.fromkeys(("count", "count_complex", "stable", "relative_margin"), doubt)


def _open_words(objective: Springs) -> str:
    """What the springs leave open, or hardly resist; empty where nothing is known to be."""
    weak = weak_shift_words(weak_shifts(objective))
    rounding = f"{weak}; the translations are of rounding as much as of the data" if weak else ""
    return "; ".join(filter(None, (Freedom.of(objective).words(), rounding)))


def _equilibrium(
    critical: LineSet, place: int, pose: Pose, objective: Springs, stiffness: float
) -> SpringEquilibrium:
    part, first = critical.components[place], critical.components[0]
    least = min(each.value for each in critical.components)
    optimal = _optimal(critical, place, part.value - least, objective.oscillation)
    angle = _angle_between(part.quaternion, first.quaternion)
    known = critical.complete and critical.tied == 1
    separated = part.guarantee is not Guarantee.NUMERICAL
    span = np.array([canonical(unit_double(vector)) for vector in part.span]).T
    falls = part.index is not None and part.index > 0
    nothing = separated and part.value < KNOWN * objective.oscillation
    energy = Fraction(0) if nothing else part.value
    return SpringEquilibrium(
        kind=ComponentKind.of_multiplicity(len(part.span)),
        separated=separated,
        morse_index=part.index,
        optimal=None if isinstance(optimal, Absent) else optimal,
        witness=_steepest(objective, part.quaternion) if falls else None,
        energy=nearest_double(energy),
        above=nearest_double(part.value - least),
        rmse=_rmse(energy, stiffness),
        pose=pose,
        basis=span,
        angle_to_first=angle,
        angle_to_optimum=angle if known else None,
        absent={
            "morse_index": NOT_SEPARATED,
            "stable": NOT_SEPARATED,
            "optimal": optimal if isinstance(optimal, Absent) else NOT_SEPARATED,
            "witness": NOT_SEPARATED if part.index is None else DEEPEST,
            "angle_to_optimum": BEST_UNKNOWN,
            **dict.fromkeys(("energy", "above", "rmse"), OUT_OF_RANGE),
        },
    )


def _optimal(
    critical: LineSet, place: int, excess: Fraction, oscillation: Fraction
) -> bool | Absent:
    """Whether a component is the best. Any rotation's energy is at least the least there is."""
    part = critical.components[place]
    separated = part.guarantee is not Guarantee.NUMERICAL
    if part.index:  # proved: the energy falls in some direction
        return False
    if separated and excess > SAME_ENERGY * oscillation:
        return False
    if critical.complete:
        if critical.tied and place >= critical.tied:
            return False
        return critical.tied == 1 or TIED
    return NOT_LISTED_WHOLE if separated else NOT_SEPARATED


def _steepest(objective: Springs, q: tuple[int, int, int, int]) -> NDArray[np.float64]:
    """The direction in which the energy falls fastest, in doubles."""
    _, curvature = slope_and_curvature(objective, q)
    return np.linalg.eigh(curvature)[1][:, 0]


def _rmse(energy: Fraction, stiffness: float) -> float | None:
    return nearest_root(energy / Fraction(stiffness)) if 0.0 < stiffness < math.inf else None


def _angle_between(p: tuple[int, ...], q: tuple[int, ...]) -> float:
    """The angle in radians between two rotations."""
    norms, along = squared_norm(p) * squared_norm(q), dot(p, q)
    across, whole = math.isqrt(norms - along**2), math.isqrt(norms)
    return 2.0 * math.atan2(across / whole, abs(along) / whole)


def _margin(critical: LineSet) -> float | None:
    """The share of the range of energies between the best and the second."""
    values = [part.value for part in critical.components]
    if critical.tied != 1 or len(values) < 2:
        return None
    apart = max(values[1] - values[0], Fraction(0))  # known to be positive, in more digits
    return float(apart / (values[-1] - values[0]))


def listed_springs(problem: RegistrationProblem, objective: Springs) -> SpringEquilibria | None:
    """The equilibria by the first method; None where it decides nothing."""
    first, *_ = FINDERS[objective.structure]
    found: Any = search(objective, first).critical
    critical: LineSet | None = found
    return None if critical is None else spring_equilibria(critical, objective, problem)


def returns(
    problem: RegistrationProblem, objective: Springs, part: SpringEquilibrium
) -> bool | None:
    """Whether a body released at rest 1 degree from an equilibrium comes back to it.

    Turned about the first axis of the source, with the translation that is best there. None where
    the equations of motion are not defined or not compiled, or the run did not come to rest.
    """
    w, x, y, z = part.basis[:, 0]
    c, s = math.cos(RELEASED / 2.0), math.sin(RELEASED / 2.0)
    turned = (c * w - s * x, c * x + s * w, c * y + s * z, c * z - s * y)
    try:
        start = spring_body(objective.moments, problem.damping).balanced(turned)
        run = simulate(objective, problem.damping, start=start)
    except (DegenerateProblemError, MissingLibraryError):
        return None
    if not run.at_rest:
        return None
    cosine = min(1.0, abs(float(np.dot(part.basis[:, 0], run.quaternion))))
    return 2.0 * math.acos(cosine) < RETURNED


@dataclass(frozen=True, slots=True, kw_only=True)
class ScaledEquilibrium(Explained):
    """A connected component of the rest states of a body whose scale is free.

    component: its rotations, kind, index and energy. scale: target over source, rounded once.
    rmse: sqrt(sum w r^2 / sum w), in the unit of the target.
    """

    component: Component
    scale: float | None
    rmse: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScaledEquilibria(Presented):
    """All equilibria with a scale above 0, the optimum first.

    rigid: those of the body of scale 1, which has the same rotations, and so the same `guarantee`
    that they are `complete`. unique: whether there is one optimum. breathing: with the scale as a
    state, their exact count and the inside-out states; None of the symmetric scale. enumeration:
    the searches for them, an `Enumeration`; None beside a registration.
    """

    rigid: EquilibriumSet
    guarantee: Guarantee
    complete: bool
    unique: bool
    components: tuple[ScaledEquilibrium, ...]
    breathing: BreathingEquilibria | None
    enumeration: Any = None

    def __repr__(self) -> str:
        count = "infinitely many" if self.count is None else self.count
        return f"<ScaledEquilibria: {count}; {self.guarantee.label}>"

    @property
    def finite(self) -> bool:
        """Whether there are finitely many."""
        return all(each.component.kind.dimension == 0 for each in self.components)

    @property
    def count(self) -> int | None:
        """Their number, exact; None means infinitely many."""
        return len(self.components) if self.finite else None

    @property
    def spurious(self) -> int | None:
        """The number of those that are not optimal; None means infinitely many."""
        others = [each.component for each in self.components if not each.component.optimal]
        return len(others) if all(each.kind.dimension == 0 for each in others) else None

    @property
    def exit_code(self) -> int:
        """What `equilibria` ends with: 0; 3 where several are optimal; 4 where more may be."""
        return code_of_list(unique=self.unique if self.complete else None)

    def stated(self, name: str) -> Any:
        """The number of that name, or why it is none."""
        value = getattr(self, name)
        return CONTINUUM if value is None else value


def scaled_equilibria(
    objective: Isotropic, rigid: EquilibriumSet, enumeration: Any = None
) -> ScaledEquilibria:
    """The equilibria of a problem whose scale is free. rigid: those of its rotations."""
    scaling, breathing = objective.scaling, None
    kept = len(rigid.components)
    if scaling is None or not scaling.symmetric:
        breathing = breathing_equilibria(objective)
        kept = len(breathing.upright)  # rigid ones come with the largest eigenvalue first
    return ScaledEquilibria(
        rigid=rigid,
        guarantee=rigid.guarantee,
        complete=rigid.complete,
        unique=rigid.classification.unique,
        components=tuple(
            _with_scale(objective, component, objective.quaternions[place])
            for place, component in enumerate(rigid.components[:kept])
        ),
        breathing=breathing,
        enumeration=enumeration,
    )


def _with_scale(objective: Isotropic, component: Component, q: Sequence[int]) -> ScaledEquilibrium:
    scale = objective.best_scale(q)
    return ScaledEquilibrium(
        component=component,
        scale=nearest_double(scale) or None,
        rmse=component.rmse,
        absent=dict.fromkeys(("scale", "rmse"), OUT_OF_RANGE),
    )


def spring_pose(problem: RegistrationProblem) -> Pose:
    """The best pose of a problem with general springs, found and not proved.

    Raises DegenerateProblemError where a shift or a turn is undetermined, or nearly so.
    """
    objective = Springs.of(problem)
    found = optimum.find_optimum(objective)
    open_ = Freedom.of(objective).words() or weak_shift_words(weak_shifts(objective))
    if not open_ and len(soft := soft_axes(objective, found.quaternion)):
        about = " and ".join(axis_words(axis) for axis in soft)
        open_ = f"rotation about the source's axis {about} is undetermined to first order"
    if open_:
        raise DegenerateProblemError(f"{open_}; certreg.certify says what is proved of it")
    return pose_at(objective, found.quaternion)
