"""How a result says what it is worth: guarantees, verdicts, statuses; and how it shows itself."""

from __future__ import annotations

import enum
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sized
from dataclasses import dataclass, field, fields, is_dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NoReturn, Protocol, TypeVar

if TYPE_CHECKING:
    from pathlib import Path

    # What a text in JSON holds, as `json.loads` reads it: objects and lists hold others of these.
    Json = dict[str, Any] | list[Any] | str | float | bool | None

T = TypeVar("T")
U = TypeVar("U")

MAX_GAP = 1e-6  # of the range: a rotation off by two thousandths of a radian costs as much
MAX_ANGLE = 1e-5  # radians: half a millimetre at fifty metres
REPR_LENGTH = 200  # characters of a repr at most
PART_LENGTH = 40  # of them for one text
MANTISSA = 53  # bits of an integer that is written out
SHOWN = "shown"  # of a field's metadata: what is shown in its place


class Brief:
    """A dataclass whose `repr` is one short line, however large its arrays are."""

    __slots__ = ()

    def __init_subclass__(cls, **arguments: Any) -> None:
        """Keep `repr` short in every subclass: `dataclass` writes none where there is one."""
        super().__init_subclass__(**arguments)
        if "__repr__" not in cls.__dict__:
            cls.__repr__ = Brief.__repr__

    def __repr__(self) -> str:
        name, parts = type(self).__name__, list[str]()
        for one in fields(self) if is_dataclass(self) else ():
            value = getattr(self, shown := one.metadata.get(SHOWN, one.name))
            if value is not None and one.repr:
                parts.append(f"{shown}={_short(value)}")
        text = f"{name}({', '.join(parts)})"
        while len(text) > REPR_LENGTH:
            parts.pop()
            text = f"{name}({', '.join((*parts, '...'))})"
        return text


def _short(value: Any) -> str:
    """A value in few characters: of an array its shape, of a text its beginning."""
    kind = type(value).__name__
    if isinstance(value, enum.Enum):
        return f"{kind}.{value.name}"
    if isinstance(value, float | Fraction) or (isinstance(value, int) and abs(value) >> MANTISSA):
        return _short_number(value)
    if isinstance(value, str | bytes) and len(value) > PART_LENGTH:
        return f"{value[: PART_LENGTH - 5]!r}..."
    if value is None or isinstance(value, str | int):
        return repr(value)
    shape: Any = getattr(value, "shape", None)
    if shape is not None:
        return f"<{kind} {tuple(shape)}>"
    return f"<{kind} of {len(value)}>" if isinstance(value, Sized) else f"<{kind}>"


def _short_number(value: Fraction | float) -> str:
    try:
        return f"{float(value):.6g}"
    except OverflowError:
        return "beyond doubles"


class Presenter(Protocol):
    """Shows results, each way by a function: of a registration alone, but for the first three.

    words: the text of the command line. document: what `--json` prints. card: HTML for a notebook,
    that loads nothing. headline: the first line. report: writes the page. save: writes the files.
    plot: draws into axes of Matplotlib.
    """

    words: Callable[[Any], str]
    document: Callable[[Any], dict[str, Any]]
    card: Callable[[Any], str]
    headline: Callable[[Any], str]
    report: Callable[[Any, str | os.PathLike[str]], Path]
    save: Callable[[Any, str | os.PathLike[str]], Path | None]
    plot: Callable[[Any, Any], Any]


_PRESENTERS: list[Callable[[], Presenter]] = []  # one: what `certreg/__init__.py` said


def present_by(find: Callable[[], Presenter]) -> None:
    """Say who shows results. How they are shown is not known up here; `report`, below, knows it."""
    _PRESENTERS[:] = [find]


def presenter() -> Presenter:
    """Who shows results."""
    return _PRESENTERS[0]()


class Shown(Brief):
    """A result that is a card where it ends a cell of a notebook."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        return presenter().card(self)


class Presented(Shown):
    """A result with the text and the document of the command line: `print` it."""

    __slots__ = ()

    def __str__(self) -> str:
        return presenter().words(self)

    def summary(self) -> str:
        """The text that the command line prints of it, as `str` does."""
        return str(self)

    def to_dict(self) -> dict[str, Any]:
        """What the command line prints with `--json`, in JSON's types."""
        return presenter().document(self)


class Saved(Presented):
    """A result that can be written to files."""

    __slots__ = ()

    def save(self, folder: str | os.PathLike[str]) -> Path | None:
        """Write what `certify --out` writes.

        Parameters
        ----------
        folder
            Made if it is missing.

        Returns
        -------
        Path | None
            Of the certificate; None where there is none.

        Raises
        ------
        InvalidFileError
            Where the files cannot be written.
        """
        return presenter().save(self, folder)

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Write one HTML file that shows the result and what is proved of it, offline.

        Parameters
        ----------
        path
            Of the file; it is written whole or not at all.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        InvalidFileError
            Where there is no certificate, or the file cannot be written.
        """
        return presenter().report(self, path)


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
class Verdict(Brief):
    """The answer of a check, in words; never a bare bool.

    Attributes
    ----------
    ruling
        One of three: what is not proved is not false.
    words
        The reason.
    tell
        Writes `theorems`, the sentences that were established; none unless `ruling` is PROVED.

    Examples
    --------
    >>> Verdict(ruling=Ruling.REFUTED, words="the digest is not that of the data")
    <Verdict.REFUTED: 'the digest is not that of the data'>
    """

    ruling: Ruling
    words: str
    tell: Callable[[], Iterable[str]] = field(
        default=tuple, compare=False, metadata={SHOWN: "theorems"}
    )

    @property
    def theorems(self) -> tuple[str, ...]:
        """The sentences that were established, written when they are read."""
        return tuple(self.tell())

    @property
    def proved(self) -> bool:
        """True if the claims were proved. False means not proved, not disproved."""
        return self.ruling is Ruling.PROVED

    def __str__(self) -> str:
        last = "VERIFIED" if self.proved else f"REFUSED: {self.words}"
        return "\n".join((*self.theorems, last))

    def __bool__(self) -> NoReturn:
        raise TypeError(
            "a verdict has three values: compare `verdict.ruling`, or ask `verdict.proved`"
        )

    def __repr__(self) -> str:
        start, words = f"<Verdict.{self.ruling.name}: ", repr(self.words)
        room = REPR_LENGTH - len(start) - 1
        return f"{start}{words if len(words) <= room else words[: room - 3] + '...'}>"


@dataclass(frozen=True, slots=True)
class Absent:
    """Stands where a value is missing, and says why in a sentence: `null` and a reason in JSON."""

    reason: str


OUT_OF_RANGE = Absent("no double holds the value: change the unit of length")


def present(value: T | Absent) -> T | None:
    """The value; None where it is missing."""
    return None if isinstance(value, Absent) else value


def mapped(value: T | Absent, to: Callable[[T], U]) -> U | Absent:
    """What a function makes of the value; why there is none where it is missing."""
    return value if isinstance(value, Absent) else to(value)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Explained(Brief):
    """A result whose missing values are None, and whose `absent` says why.

    absent: of each attribute that is None and has a reason; of what is given, only these are kept.
    """

    absent: Mapping[str, Absent] = field(
        default_factory=dict[str, Absent], compare=False, repr=False
    )

    def __post_init__(self) -> None:
        if self.absent:
            given = self.absent.items()
            missing = {name: why for name, why in given if getattr(self, name) is None}
            object.__setattr__(self, "absent", missing)

    def stated(self, name: str) -> Any:
        """The attribute of that name, or the Absent that stands for it.

        Parameters
        ----------
        name
            Of an attribute that may be None.

        Returns
        -------
        Any
            Its value; where that is None, the reason.
        """
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
                what = "radians" if name == "max_angle" else "a share"
                raise ValueError(f"{name} is {value!r}: give {what}, from 0 to below {whole:.6g}")


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
    BOUNDED = "bounded"  # general springs: a gap alone is proved, and not how near an optimum is
    SPURIOUS_EQUILIBRIUM = "spurious-equilibrium"
    NOT_AN_EQUILIBRIUM = "not-an-equilibrium"
    NOT_A_ROTATION = "not-a-rotation"
