"""How a result says what it is worth: guarantees, verdicts, statuses."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

if TYPE_CHECKING:
    from collections.abc import Mapping

T = TypeVar("T")

MAX_GAP = 1e-6  # of the range: a rotation off by two thousandths of a radian costs as much
MAX_ANGLE = 1e-5  # radians: half a millimetre at fifty metres


class Guarantee(enum.IntEnum):
    """How a result is known. The guarantee of a combination is the `min` of its parts.

    >>> min(Guarantee.EXACT, Guarantee.NUMERICAL).label
    'numerical'
    """

    NUMERICAL = 0  # floating point: right up to rounding nobody has bounded
    ENCLOSED = 1  # a rigorous enclosure
    EXACT = 2  # integer arithmetic and a theorem

    @property
    def label(self) -> str:
        """The lower-case word used in files."""
        return self.name.lower()


class Ruling(enum.Enum):
    """The three answers that a check can give."""

    PROVED = "proved"
    REFUTED = "refuted"
    INCONCLUSIVE = "inconclusive"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Verdict:
    """The answer of a check, in words; never a bare bool.

    `theorems` are the sentences that were established; empty unless `ruling` is PROVED.

    >>> Verdict(ruling=Ruling.REFUTED, words="the digest is not that of the data")
    <Verdict.REFUTED: 'the digest is not that of the data'>
    """

    ruling: Ruling
    words: str
    theorems: tuple[str, ...] = ()

    @property
    def proved(self) -> bool:
        """True if the claims were proved. False means not proved, not disproved."""
        return self.ruling is Ruling.PROVED

    def __bool__(self) -> NoReturn:
        message = "a verdict has three values: compare `verdict.ruling`, or ask `verdict.proved`"
        raise TypeError(message)

    def __repr__(self) -> str:
        return f"<Verdict.{self.ruling.name}: {self.words!r}>"


@dataclass(frozen=True, slots=True)
class Absent:
    """Stands where a value is missing, and says why in a sentence: `null` and a reason in JSON."""

    reason: str


OUT_OF_RANGE = Absent("no double holds the value: change the unit of length")


def present(value: T | Absent) -> T | None:
    """The value; None where it is missing."""
    return None if isinstance(value, Absent) else value


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explained:
    """A result whose missing values are None, and whose `absent` says why.

    absent: of each attribute that is None and has a reason; of what is given, only these are kept.
    """

    absent: Mapping[str, Absent] = field(
        default_factory=dict[str, Absent], compare=False, repr=False
    )

    def __post_init__(self) -> None:
        missing = {name: why for name, why in self.absent.items() if getattr(self, name) is None}
        object.__setattr__(self, "absent", missing)

    def stated(self, name: str) -> Any:
        """The attribute of that name, or the Absent that stands for it."""
        value = getattr(self, name)
        return self.absent[name] if value is None else value


class Optimality(enum.Enum):
    """What is proved of the pose; the value is the word used in files."""

    CERTIFIED = "certified"
    CERTIFIED_NOT_UNIQUE = "certified-not-unique"
    BOUNDED = "bounded"  # proved bounds, but wider than the limits of "certified"
    NOT_CERTIFIED = "not-certified"


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """How close to the minimum a pose must be proved to be, to be called certified.

    max_gap: of objective - minimum, as a share of the range of energies over all rotations.
    max_angle: radians from the optimum, where that is unique. Raises ValueError for less than zero,
    and for a limit that every rotation meets: the whole range of energies, or half a turn.
    """

    max_gap: float = MAX_GAP
    max_angle: float = MAX_ANGLE

    def __post_init__(self) -> None:
        for name, whole in (("max_gap", 1.0), ("max_angle", math.pi)):
            value = getattr(self, name)
            if not 0.0 <= value < whole:
                raise ValueError(f"{name} is {value!r}: give a number from 0 to below {whole:.6g}")


class ComponentKind(enum.Enum):
    """What a connected component of the equilibrium set looks like."""

    POINT = "point"  # one rotation
    CIRCLE = "circle"  # RP^1
    PROJECTIVE_PLANE = "projective-plane"  # RP^2
    ROTATION_GROUP = "rotation-group"  # RP^3 = SO(3)

    @property
    def dimension(self) -> int:
        """Dimension of the component as a manifold, 0 to 3."""
        return list(ComponentKind).index(self)

    @classmethod
    def of_multiplicity(cls, multiplicity: int) -> ComponentKind:
        """Kind of the projective space of an eigenspace of that dimension, 1 to 4."""
        return _KINDS[multiplicity - 1]


_KINDS = tuple(ComponentKind)  # listing an enumeration anew costs a microsecond


class PoseVerdict(enum.Enum):
    """What `assess` says of a pose; the value is the word used in files."""

    OPTIMAL = "optimal"
    NEAR_OPTIMAL = "near-optimal"
    SPURIOUS_EQUILIBRIUM = "spurious-equilibrium"
    NOT_AN_EQUILIBRIUM = "not-an-equilibrium"
    NOT_A_ROTATION = "not-a-rotation"
