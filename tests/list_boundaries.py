"""What the checker must say of lists of equilibria just inside and just outside its inequalities.

Cases as those of `checker_boundaries`. What is right is found here by exact fractions from the
problem's objective, which shares no formula with the checker, or is plain from the example: of six
planes all 40 lines are known, their entries are 0, 1 and -1.
"""

from __future__ import annotations

import copy
import hashlib
import json
from fractions import Fraction
from functools import cache
from itertools import product
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from checker_boundaries import Case, outcome_of, value_of
from spring_families import Cell, instance, statement
from springs_boundaries import pair

from certreg.certificate.listing import springs_list_certificate
from certreg.equilibrium.paths import critical_lines
from certreg.objective.quartics import MONOMIALS
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


Document = dict[str, Any]
Quaternion = tuple[int, ...]
RANGE = "REFUSED: bits, chart, lines or modulus are out of range$"
APART = "REFUSED: the boxes are not 40 that are apart$"
RANKS = "REFUSED: chart and modulus do not prove that 40 are all$"
BOX = "REFUSED: a box is not seen to hold one line$"
POSE = "REFUSED: the pose is not that of the first real line$"
# How an answer begins that costs 50 ms: the checker has looked into the boxes before.
LATE = ("VERIFIED", "(VERIFIED", "REFUSED: claims", "(REFUSED: claims", BOX, POSE)
TWO = Fraction(2)


class Listed:
    """A problem and the certificate of all its equilibria; document: its JSON."""

    def __init__(self, problem: RegistrationProblem) -> None:
        """As it is produced."""
        self.problem, self.objective = problem, Springs.of(problem)
        lines = critical_lines(self.objective.floating_quartic()[0])
        self.certificate: Any = springs_list_certificate(problem, self.objective, lines)
        self.document: Document = json.loads(self.certificate.to_json())

    @property
    def quaternions(self) -> tuple[Quaternion, ...]:
        """Of the equilibria."""
        return self.certificate.body.quaternions


@cache
def listed(family: str = "plane", n: int = 7, noise: float = 0.05, seed: int = 1) -> Listed:
    """A random problem."""
    return Listed(RegistrationProblem(**statement(instance(Cell(family, n, noise), seed))))


@cache
def six_planes() -> Listed:
    """All 40 lines are real, eight of them stable: the best, with one energy."""
    points = np.array([s * row for row in np.eye(3) for s in (1.0, -1.0)])
    return Listed(RegistrationProblem(points, 0.0 * points, normals=np.abs(points)))


def good() -> Document:
    """Of seven planes."""
    return listed().document


def other(document: Document | None = None, /, **entries: Any) -> Document:
    """With other entries, of claims and proof."""
    found = copy.deepcopy(document or good())
    for name, value in entries.items():
        next(found[part] for part in ("claims", "proof") if name in found[part])[name] = value
    return found


def with_lines(change: Callable[[list[list[int]]], Any], document: Any = None) -> Document:
    """With other boxes: the change is made to the list of rows."""
    found = other(document)
    proof = found["proof"]
    rows = [proof["lines"][k : k + 6] for k in range(0, len(proof["lines"]), 6)]
    change(rows)
    proof["lines"] = [k for row in rows for k in row]
    return found


def moved(line: int, place: int, by: int, document: Any = None) -> Document:
    """With one coordinate of one centre changed."""

    def change(rows: list[list[int]]) -> None:
        rows[line][place] += by

    return with_lines(change, document)


def mean(case: Listed) -> Fraction:
    """Of the quartic over the unit sphere: that of q_i^4 is 1/8, of q_i^2 q_j^2 1/24."""
    of_powers = {(4,): Fraction(1, 8), (2, 2): Fraction(1, 24)}
    total = Fraction(0)
    for c, m in zip(case.objective.quartic, MONOMIALS, strict=True):
        powers = tuple(sorted((m.count(i) for i in {*m}), reverse=True))
        total += c * of_powers.get(powers, 0)
    return total


def turned(case: Listed) -> dict[Quaternion, Fraction]:
    """What the checker adds up of the quartic in the chart: 256 terms of F(a p) - mean |a p|^4."""
    w, x, y, z = case.document["proof"]["chart"]
    left = [[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]
    level, total = mean(case), dict.fromkeys(product(range(4), repeat=4), Fraction(0))
    for c, m in zip(case.objective.quartic, MONOMIALS, strict=True):
        square = m[0] == m[1] and m[2] == m[3]
        entry = c - level * square * (1 if m[0] == m[3] else 2)
        for p in total:
            total[p] += (
                entry * left[m[0]][p[0]] * left[m[1]][p[1]] * left[m[2]][p[2]] * left[m[3]][p[3]]
            )
    return total


@cache
def bounds() -> tuple[Fraction, Fraction, Fraction]:
    """Of the good one: the gap, the second value and sin^2 of the angle, as they are proved."""
    case, chart = listed(), good()["proof"]["chart"]
    norm = sum(k * k for k in chart)
    width = sum(map(abs, turned(case).values())) * 2 * case.objective.unit
    floors, sines = list[Fraction](), list[Fraction]()
    for q in case.quaternions:
        sines.append(Fraction(3 * norm, sum(k * k for k in q)))
        floors.append(case.objective.energy(q) - 10 * width * sines[-1] / norm**2)
    return case.objective.energy(case.quaternions[0]) - min(floors), min(floors[1:]), sines[0]


def questions() -> Iterator[tuple[str, Document, str]]:
    """Name, certificate, and what the answer begins with."""
    proof, claims = good()["proof"], good()["claims"]
    gap, second, sine = bounds()
    yield "accepted", good(), "VERIFIED"
    for name, bound, up in (("gap", gap, 1), ("second", second, 0), ("sin2_half_angle", sine, 1)):
        refusal = f"REFUSED: claims.{name} is not proved$"
        for inside in (True, False):
            entry = pair(bound, up if inside else 1 - up)
            answer = "VERIFIED" if inside else refusal
            yield f"{name} {inside}", other(**{name: entry}), answer
    yield "nothing of uniqueness", other(unique=None, sin2_half_angle=None), "VERIFIED.*undecided"
    yield "not unique", other(unique=False), "REFUSED: claims.unique is not proved$"
    for name, value in (("second below 0", [-1, 0]), ("gap of more", [1, 0])):
        yield name, other(**{name.split()[0]: value}), "VERIFIED"
    low = other(second=pair(listed().objective.energy(listed().quaternions[0]), 0))
    yield "no barrier", low, "VERIFIED.*not proved to be above R's"
    yield "pose of another length", other(pose=[-3 * k for k in proof["pose"]]), "VERIFIED"
    yield "no pose", other(pose=[0] * 4), POSE
    for k in range(4):
        near = [entry + (j == k) for j, entry in enumerate(proof["pose"])]
        yield f"pose off in {k}", other(pose=near), POSE
    for k in range(len(claims["indices"])):
        wrong = [*claims["indices"]]
        wrong[k] = (wrong[k] + 1) % 4
        yield f"index {k}", other(indices=wrong), "REFUSED: claims.indices is not proved$"
    swapped = [claims["indices"][-1], *claims["indices"][1:-1], claims["indices"][0]]
    yield "indices swapped", other(indices=swapped), "REFUSED: claims.indices is not proved$"
    yield "an index less", other(indices=claims["indices"][1:]), "REFUSED: claims.indices"
    yield from _ranges(proof)
    yield from _pairs()
    yield from _six()
    yield from _boxes()


def _ranges(proof: Document) -> Iterator[tuple[str, Document, str]]:
    w, x, y, z = proof["chart"]
    for name, chart, answer in (
        ("zero", [0] * 4, RANGE),
        ("too large", [w, x, 2**16 + 1, z], RANGE),
        ("too large, below", [1, 1, -(2**16) - 1, 1], RANGE),
        ("large", [w, x, 2**16, z], BOX),
        ("another", [w + 1, x, y, z], BOX),
    ):
        yield f"chart {name}", other(chart=chart), answer
    for name, bits, answer in (
        ("below 0", -1, RANGE),
        ("0", 0, BOX),
        ("256", 256, BOX),
        ("257", 257, RANGE),
        ("one more", proof["bits"] + 1, BOX),
    ):
        yield f"bits {name}", other(bits=bits), answer
    for modulus, answer in (
        (-7, RANGE),
        (1, RANGE),
        (2, RANKS),
        (2**61 - 1, "VERIFIED"),
        (2**62 - 57, "VERIFIED"),
        (2**62 - 1, "(VERIFIED|REFUSED: chart and modulus)"),
        (2**62, RANGE),
        (10007 * 10009, "VERIFIED"),
        (3**20, RANKS),
    ):
        yield f"modulus {modulus}", other(modulus=modulus), answer
    for name, size, answer in (("large", 2**512 - 1, BOX), ("too large", 2**512, RANGE)):
        yield f"a centre {name}", with_lines(lambda rows, size=size: _set(rows, size)), answer
        yield (
            f"a centre {name}, below",
            with_lines(lambda rows, size=size: _set(rows, -size)),
            answer,
        )


def _set(rows: list[list[int]], size: int) -> None:
    rows[-1][4] = size


def _boxes() -> Iterator[tuple[str, Document, str]]:
    real = len(good()["claims"]["indices"])

    def copied(by: list[int], line: int, onto: int) -> Document:
        def change(rows: list[list[int]]) -> None:
            rows[onto] = [a + b for a, b in zip(rows[line], by, strict=True)]

        return with_lines(change)

    yield "one twice", copied([0] * 6, 0, 1), APART
    yield "a pair twice", copied([0] * 6, real, real + 1), APART
    for by, answer in (([2, 0], APART), ([2, 1], BOX), ([0, 2], APART), ([-2, 1], BOX)):
        for place in (0, 2, 4):
            shift = [*[0] * place, *by, *[0] * (4 - place)]
            yield f"a pair off by {shift}", copied(shift, real, real + 1), answer
    yield "a pair off by 2, twice", copied([2, 0, 0, 2, 0, 0], real, real + 1), APART

    for line in (0, 1, real, real + 3):
        for place in range(0, 6, 1 + (line < real)):
            for by in (-2, 2):
                yield f"line {line}, place {place}, {by}", moved(line, place, by), BOX


def _pairs() -> Iterator[tuple[str, Document, str]]:
    real = len(good()["claims"]["indices"])

    def mirror(rows: list[list[int]]) -> None:
        rows[real + 1] = [(-1) ** k * entry for k, entry in enumerate(rows[real])]

    def real_pair(part: int) -> Callable[[list[list[int]]], None]:
        def change(rows: list[list[int]]) -> None:
            rows[real][1::2] = [0, part, 0]

        return change

    yield "a pair and its mirror image", with_lines(mirror), APART
    yield "a pair that is nearly real", with_lines(real_pair(1)), APART
    yield "a pair that is not", with_lines(real_pair(2)), BOX
    yield "a pair as a real line", with_lines(real_pair(0)), APART
    yield "a line left out", with_lines(lambda rows: rows.pop(1)), APART
    yield "a pair left out", with_lines(lambda rows: rows.pop()), APART
    yield "a line more", with_lines(lambda rows: rows.append([5 << 70] * 5 + [0])), APART
    yield (
        "another order",
        with_lines(lambda rows: rows.reverse()),
        "(REFUSED: claims|REFUSED: the p)",
    )


def _six() -> Iterator[tuple[str, Document, str]]:
    """Six planes."""
    whole = six_planes().document
    told = "VERIFIED.*No angle is bounded.*undecided"
    told += ".*: 40, no others.*Stable: 8.*ways down: 16, 12, 4.*not proved to be above R's"
    yield "forty real", whole, told
    yield "forty real, unique", other(whole, unique=True), "REFUSED: claims.unique is not proved$"
    angle = other(whole, sin2_half_angle=[1, 0])
    yield "forty real, an angle", angle, "REFUSED: claims.sin2_half_angle is not proved$"
    for chart in ([1, 1, 0, 0], [1, 2, 3, 0], [0, 0, 0, 1], [1, 2, 4, -7]):  # orthogonal to a line
        yield f"a plane through a line, {chart}", other(whole, chart=chart), RANKS


Question = tuple[str, "Callable[[Any], object]", str]


def direct_questions() -> Iterator[Question]:
    """Of functions of the checker, where data lead to no boundary."""
    for k in (3, 4):
        rows = [[int(i == j) for j in range(5)] for i in range(k)]
        yield f"rank {k} of 4", lambda c, rows=rows: c.has_rank([*rows, rows[0]], 4, 7), str(k == 4)
    room = (1000 * 64**3 - 1) // (12 * 65**2)  # 12 s^2 most < 1000 N^3, s = N + 1
    yield "room in a box, inside", lambda c: held(c, room), "True"
    yield "room in a box, outside", lambda c: held(c, room + 1), "False"
    fits = (1000 * 64**3 * 4 // 100 - 1) // (12 * 65**2)
    for offset in (15, -15):  # |Y E| = 0.96
        yield f"off by {offset}, inside", lambda c, o=offset: held(c, fits, o), "True"
        yield f"off by {offset}, outside", lambda c, o=offset: held(c, fits + 1, o), "False"
    yield "off by an imaginary unit", lambda c: held(c, 0, 0, 1), "False"
    yield "off by nothing", lambda c: held(c, 0), "True"
    yield "off by more", lambda c: held(c, 1, 16), "False"
    least = -(-420 * 9**4 // 64)  # N^2 |eigenvalue| >= 420 s^4 most
    for signs in product((1, -1), repeat=3):
        inside = tuple((least + 1) * s for s in signs)
        outside = tuple((least + 1 - 2 * (k == 1)) * s for k, s in enumerate(signs))
        yield f"index {signs}", lambda c, d=inside: index(c, d), str(signs.count(-1))
        yield f"index {signs} open", lambda c, d=outside: index(c, d), "'open'"
    yield "an index and larger coefficients", lambda c: index(c, (least + 1,) * 3, 2), "'open'"
    yield "an index that skew parts do not change", skew, "0"
    for name, width, claims, answer in (
        ("apart", Fraction(1, 181), {"unique": True, "sin2_half_angle": Fraction(3)}, "True"),
        ("touching", Fraction(1, 180), {"unique": True}, "False"),
        ("touching, an angle", Fraction(1, 180), {"sin2_half_angle": Fraction(3)}, "False"),
        ("touching, no claim", Fraction(1, 180), {}, "True"),
        ("a smaller angle", Fraction(1, 181), {"sin2_half_angle": Fraction(299, 100)}, "False"),
    ):
        yield f"values {name}", lambda c, w=width, k=claims: settled(c, w, k), answer
    for H in (
        [[1, 2, 0], [2, 1, 0], [0, 0, 5]],
        [[-1, 0, 3], [0, 2, 0], [3, 0, -7]],
        [[5, 1, 2], [1, 6, 3], [2, 3, 7]],
        [[-1, 0, 0], [0, 4, 5], [0, 5, 4]],
        [[0, 1, 0], [1, 0, 1], [0, 1, -1]],
    ):
        expected = int((np.linalg.eigvalsh(np.array(H, float)) < 0).sum())
        yield f"index of {H}", lambda c, H=H: bent(c, H), str(expected)


def held(checker: Any, most: int, offset: int = 0, part: int = 0) -> bool:
    """Whether a box holds a zero of 1000 p_0^3 p_i, i = 2 less offset p_0^4.

    At P the p_i are (part i, 0, 0), of which the zero is offset 64/1000 away in p_2.
    """
    tables: list[Any] = []
    for i in (1, 2, 3):
        E = dict.fromkeys(checker.QUARTICS, 0)
        E[0, 0, 0, i], E[0, 0, 0, 0] = 1000, -offset * (i == 2)
        tables.append(checker.derivatives(E))
    try:
        checker.slopes_at([(64, 0), (0, part), (0, 0), (0, 0)], tables, most)
    except checker.RefusalError:
        return False
    return True


def index(checker: Any, diagonal: tuple[int, ...], most: int = 1) -> Any:
    """The index where J is diagonal, at P = (8, 0, 0, 0)."""
    J = [[(a * (i == j), 0) for j in range(3)] for i, a in enumerate(diagonal)]
    try:
        return checker.index_of([(8, 0), (0, 0), (0, 0), (0, 0)], J, most)
    except checker.RefusalError:
        return "open"


def skew(checker: Any) -> int:
    """The index where the symmetric part of J is positive definite, and one triangle's is not."""
    J = [[(4 << 40, 0), (6 << 40, 0), (0, 0)], [(0, 0), (4 << 40, 0), (0, 0)]]
    J.append([(0, 0), (0, 0), (1 << 40, 0)])
    return checker.index_of([(8, 0), (0, 0), (0, 0), (0, 0)], J, 1)


def settled(checker: Any, width: Fraction, claims: dict[str, Any]) -> bool:
    """Of w^4 at x, where it is 0 -+ 30 width, and at w + x, where it is 1/4 -+ 15 width."""
    springs = checker.CheckedSprings([1] + [0] * 34, Fraction(1), 0, Fraction(1), Fraction(1))
    stated = SimpleNamespace(
        **{"unique": None, "sin2_half_angle": None, **claims},
        pose=(0, 1, 0, 0),
        chart=(1, 0, 0, 0),
        gap=Fraction(9),
        second=Fraction(-9),
        n=1,
        digest="",
        rotation_only=None,
        _told=lambda _: [],
    )
    settle: Any = vars(checker.SpringsListStatement)["_settled"]
    try:
        return settle(stated, springs, [[0, 1, 0, 0], [1, 1, 0, 0]], width).verified
    except checker.RefusalError:
        return False


def bent(checker: Any, H: list[list[int]]) -> int:
    """The index where J is a multiple of B^-1 H, B = |p|^2 I - v v^T, so I + v v^T/p_0^2."""
    v, N, three = (3, -5, 7), 2, range(3)
    inverse = [[N * N * (i == j) + v[i] * v[j] for j in three] for i in three]
    J = [[sum(inverse[i][k] * H[k][j] for k in three) << 60 for j in three] for i in three]
    return checker.index_of([(k, 0) for k in (N, *v)], [[(k, 0) for k in row] for row in J], 1)


def words() -> str:
    """The pattern of the theorems that lists alone have."""
    claims = good()["claims"]
    counts = [claims["indices"].count(k) for k in range(4)]
    value = listed().objective.energy(listed().quaternions[0])
    number = claims["second"][0] * TWO ** claims["second"][1]
    return (
        r"VERIFIED.*Every global optimum is within [\d.e-]+ degrees of R\..*unique: every other.*"
        f"Rotations at equilibrium: {sum(counts)}, no others. "
        r"All 40 complex solutions are simple\."
        f"\nStable: {counts[0]}. Unstable, with 1, 2, 3 ways down: {counts[1]}, {counts[2]}, "
        f"{counts[3]}.\nAt all equilibria but that of R the objective is at least "
        f"{float(number):.11g}"[:-2]
        + rf".*: more than {float(number - value):.9g}"[:-2]
    )


@cache
def _cases() -> tuple[Case, ...]:
    made = [Case(name, value_of(ask), f"{answer}$") for name, ask, answer in direct_questions()]
    made.append(Case("words of a list", outcome_of(good()), words()))
    made += [Case(name, outcome_of(document), answer) for name, document, answer in questions()]
    return tuple(sorted(made, key=lambda case: case.answer.startswith(LATE)))


def list_cases() -> list[Case]:
    """All cases of lists, those first that are answered before a box is looked into."""
    return list(_cases())


def early_list_cases() -> list[Case]:
    """Of all cases these take a hundredth of the time."""
    return [case for case in _cases() if not case.answer.startswith(LATE)]


_FORTY: dict[tuple[str, int, str], bool] = {}  # what `are_forty` of a text said of forms


def remember_forty(checker: Any, text: str = "") -> None:
    """Let a checker remember what its `are_forty` says, which takes 40 of the 50 ms of a list.

    Forgeries and mutants leave nearly all forms alone. text: of the functions that decide.
    """
    decide = checker.are_forty

    def are_forty(minors: Any, modulus: int) -> bool:
        key = text, modulus, hashlib.sha256(repr(minors).encode()).hexdigest()
        if key not in _FORTY:
            _FORTY[key] = decide(minors, modulus)
        return _FORTY[key]

    checker.are_forty = are_forty
