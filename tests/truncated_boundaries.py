"""What the checker must say of truncated squares just inside and outside of its inequalities.

Cases as those of `checker_boundaries`. The stretched octahedron has, with bounds of 1/2, the costs
0 and 416, 320, 160 a sin^2 of half an angle about its axes: sums of 4 |x|^2 / b^2 off the axis.
"""

from __future__ import annotations

import base64
import hashlib
import struct
from fractions import Fraction
from functools import cache
from itertools import chain, combinations_with_replacement
from typing import TYPE_CHECKING, Any

import certificates as oracle
from checker_boundaries import NEAR, Ask, Case, changed, dyadic, outcome_of, value_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

Document = dict[str, Any]
PREFIX = b"certreg-truncated-rotation/1\0"
AXES = [[float(k) for k in row] for row in oracle.stretched((3, 2, 1))]
FAR = [[5.0, 0.0, 0.0], [-5.0, 0.0, 0.0]]
PRODUCTS = [*combinations_with_replacement(range(4), 2)]
OPEN: Document = {"sin2_half_angle": None, "unique": False}
MANY = "REFUSED: the labels or the gap need too many boxes$"
ANGLE, UNIQUE = "claims.sin2_half_angle is not proved", "claims.unique is not proved"
LABELS, RANGE = r"labels are not n of 1, 0, \?", "gap or pose is out of range"
CHORD = 2**32
# Two optima: three pairs want a quarter turn about z, three the one back; the third axis stays.
TWO = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 3.0]]
TIED = [[0.0 - y, x, z] for x, y, z in TWO] + [[y, 0.0 - x, z] for x, y, z in TWO]


def document(
    source: Any = (*AXES, *FAR),
    target: Any = (*AXES, FAR[1], FAR[0]),
    bounds: Sequence[float] = (0.5,) * 8,
    weights: Sequence[float] | None = None,
    **claims: Any,
) -> Document:
    """A certificate of the identity, for the octahedron and two pairs that are wrong."""
    n = len(source)
    numbers = [*chain(*source), *chain(*target), *(weights or [1.0] * n), *bounds]
    content = PREFIX + struct.pack(f"<Q{len(numbers)}d", n, *numbers)
    made = {"gap": [1, -20], "labels": "11111100", "sin2_half_angle": [1, -20], "unique": True}
    return {
        "about": {},
        "claims": made | claims,
        "format": "certreg-certificate/1",
        "kind": "truncated-rotation",
        "optimality": {"mu": [64, 0]},
        "pose": [1, 0, 0, 0],
        "problem": {
            "data": base64.b64encode(content).decode(),
            "digest": hashlib.sha256(content).hexdigest(),
            "n": n,
        },
    }


def told(content: Document, **limits: int) -> Ask:
    """The outcome, with a budget that no case needs: mutants are not to search for minutes."""
    return outcome_of(content, **({"TESTS_MAX": 1 << 18} | limits))


def _near(name: str, parts: Callable[[Fraction], Document], refusal: str) -> Iterator[Case]:
    """Two cases of certificates at 1 -+ 1e-9, refused where the factor is above 1."""
    yield Case(f"{name}, inside", told(parts(1 - NEAR)), "VERIFIED")
    yield Case(f"{name}, outside", told(parts(1 + NEAR)), f"REFUSED: {refusal}$")


@cache
def truncated_cases() -> list[Case]:
    """All cases; a copy for each who asks would not cost much, but nobody changes it."""
    return [*_forms(), *_positive(), *_survey(), *_claims(), *_labels(), *_data(), *_worth()]


def _line(x: Sequence[int], y: Sequence[int]) -> list[list[int]]:
    """The matrix of q to y q - q x, by Hamilton's table."""
    a, b, c = (j - i for i, j in zip(x, y, strict=True))
    d, e, f = (j + i for i, j in zip(x, y, strict=True))
    return [[0, -a, -b, -c], [a, 0, -f, e], [b, f, 0, -d], [c, -e, d, 0]]


def _forms() -> Iterator[Case]:
    """Coefficients and reaches, rounded as they are said to be."""
    rows = [
        [1, 2, 3, -4, 5, 6, 7],
        [0, 0, 0, 1, -1, 2, 3],
        [9, -8, 7, 0, 0, 0, 11],
        [10**9, 3, -(10**8), 10**9, 5, 7, 3],
    ]
    for row in rows:
        B = _line(row[:3], row[3:6])
        M = [[sum(B[k][i] * B[k][j] for k in range(4)) for j in range(4)] for i in range(4)]
        exact = [M[i][j] * (1 if i == j else 2) for i, j in PRODUCTS]
        square = row[6] ** 2
        form = [
            (k << 64) // square - 3 * (i == j) for k, (i, j) in zip(exact, PRODUCTS, strict=True)
        ]
        least = 12 * min(sum(k * k for k in row[:3]), sum(k * k for k in row[3:6])) << 64
        reach = 1
        if least:
            reach = _root(Fraction(least // square)) + 1
        said = repr((form, reach)).replace("(", r"\(").replace("[", r"\[").replace(")", r"\)")
        yield Case(f"form of {row}", value_of(lambda c, row=row: c.form_of(row)), f"{said}$")
    q = [2, -3, 5, 7]
    whole = sum(k * q[i] * q[j] for k, (i, j) in zip(range(1, 11), PRODUCTS, strict=True))
    yield Case("form at q", value_of(lambda c: c.form_at([*range(1, 11)], q)), f"{whole}$")


def _root(value: Fraction) -> int:
    """The integer part of the root."""
    low, high = 0, int(value) + 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if middle * middle <= value else (low, middle)
    return low


def _form(**coefficients: int) -> list[int]:
    """By names such as q01; in units of CHORD."""
    return [CHORD * coefficients.get(f"q{i}{j}", 0) for i, j in PRODUCTS]


def _positive() -> Iterator[Case]:
    """A form in a box: by its value, slopes and curvature at the centre, or everywhere."""

    def ask(form: list[int], *rest: Any) -> Any:
        return value_of(lambda c: c.positive(form, *rest))

    square = _form(q00=5, q11=5, q22=5, q33=5)
    low = [k - (i == j == 2) for k, (i, j) in zip(square, PRODUCTS, strict=True)]
    yield Case("above 0 everywhere", ask(square, [8, 0, 0, 0], 0, 8, 4, 0), "True$")
    yield Case("0 on a line", ask(square, [8, 0, 0, 0], 0, 8, 5, 0), "False$")
    yield Case("below 0 on a line", ask(low, [8, 0, 0, 0], 0, 8, 5, 0), "False$")
    # At (8, 0, 0, 0) with h = 4: 64 (a - s) > 4 (8 |b| + ...) + 48 (s + k).
    for f in range(4):
        q, name = [8 * (j == f) for j in range(4)], f"q{f}{f}"
        other = f"q{min(f, (f + 1) % 4)}{max(f, (f + 1) % 4)}"
        for b, a in ((0, Fraction(13, 4)), (2, Fraction(17, 4)), (-2, Fraction(17, 4))):
            level = [k * 4 for k in _form(**{other: b})]
            at = PRODUCTS.index((f, f))
            for up in (0, 1):
                form = [k // 4 for k in level]
                form[at] = int(a * CHORD) + up
                asked = ask(form, q, f, 4, 1, 2)
                yield Case(f"{name} {b} and {up} more", asked, f"{bool(up)}$")
    two = _form(q01=2, q11=-1)
    two[0] = 1
    yield Case("two entries of the centre", ask(two, [8, 8, 0, 0], 0, 1, 0, 0), "True$")
    yield Case("a wider box", ask(two, [8, 8, 0, 0], 0, 8, 0, 1), "False$")
    yield Case("spare below 0", ask(_form(q00=1), [8, 0, 0, 0], 0, 8, -1, 0), "True$")
    mixed = _form(q01=1, q11=-2)
    yield Case("no curvature below 0", ask(mixed, [8, 0, 0, 0], 0, 8, -1, 0), "False$")
    slack = _form(q00=4)
    yield Case("slack counts", ask(slack, [8, 0, 0, 0], 0, 8, 0, 2), "False$")
    yield Case("no slack", ask(slack, [8, 0, 0, 0], 0, 8, 0, 1), "True$")


def _survey() -> Iterator[Case]:
    """Pairs of one residual everywhere, that reach half a bound further, in the four boxes."""
    bound, many = 2**64, 2**67
    names = ("in", "out")

    def ask(squares: list[int], labels: str, cost: int, gap: int) -> Any:
        form = [[s * (i == j) for i, j in PRODUCTS] for s in squares]

        def question(checker: Any) -> str:
            kept = checker.TESTS_MAX
            checker.TESTS_MAX = 4 * (16 + len(squares))
            try:
                checker.survey([(each, 2**31) for each in form], labels, cost, gap)
            except checker.RefusalError:
                return "refused"
            finally:
                checker.TESTS_MAX = kept
            return "proved"

        return question

    # In: r + 1/2 <= 1, with 6 units for rounding; out: r - 1/2 > 1.
    edges = {"in": bound // 4 - 6, "out": 9 * bound // 4}
    for name, label in zip(names, "10", strict=True):
        for up in (0, 1):
            right = (up == 0) == (name == "in")
            asked = ask([edges[name] + up], label, 2 * bound, many)
            yield Case(f"{name}, {up} more", asked, "proved$" if right else "refused$")
            other = ask([edges[name] + up], "01"[label == "0"], 2 * bound, many)
            yield Case(f"{name}, {up} more, not so labelled", other, "refused$")
    yield Case("out at the cost", ask([3 * bound], "1", bound, many), "refused$")
    yield Case("out above the cost", ask([3 * bound], "1", bound - 1, many), "proved$")
    # Open ones: r = 1 counts as 1 / (3/2)^2.
    for count in (1, 2):
        least = count * 4 * bound // 9
        for name, spare in (("inside", least - 2**44), ("outside", least + 2**44)):
            asked = ask([bound] * count, "?" * count, many + spare, many)
            yield Case(f"{count} open, {name}", asked, "pro" if name == "inside" else "ref")


def _claims() -> Iterator[Case]:
    good = document()
    yield Case("the octahedron", told(good), "VERIFIED\n")
    # A turn by sin(a/2) = 3/5 is out of the bounds; (50, 0, 0, 1) is within, off by 1/2501.
    off = good | {"pose": [50, 0, 0, 1]}
    excess = Fraction(416, 2501)
    claims = {"gap": [1, 9], **OPEN}
    free = changed(off, claims=good["claims"] | claims)

    def gap(factor: Fraction) -> Document:
        value = excess * (2 - factor)  # more is easier
        return changed(free, gap=[int(value * 2**80), -80])

    yield from _near("gap", gap, MANY.removeprefix("REFUSED: ").removesuffix("$"))
    # L - (mu - delta) I + mu u u^T > 0, the least across u is 160: mu (1 - s) < 160.
    for s in (Fraction(1, 2**20), Fraction(1, 2)):

        def mu(factor: Fraction, s: Fraction = s) -> Document:
            number = factor * 160 / (1 - s)
            return changed(good, mu=[int(number * 2**60), -60], sin2_half_angle=dyadic(s))

        yield from _near(f"mu, {s}", mu, ANGLE)

    # delta along u: 416 / 2501 is below it.
    def angle(factor: Fraction) -> Document:
        least = _least_sine(excess, Fraction(16)) * (2 - factor)
        return changed(off, gap=[1, 0], mu=[16, 0], sin2_half_angle=[int(least * 2**80), -80])

    yield from _near("angle", angle, ANGLE)
    whole = changed(good, sin2_half_angle=[1, 0])
    more = changed(good, sin2_half_angle=dyadic(1 + NEAR))
    yield Case("unique by mu", told(whole), "VERIFIED\n.*The global optimum is unique")
    yield Case("not unique by mu", told(more), f"REFUSED: {UNIQUE}$")
    yield Case("not claimed", told(changed(more, unique=False)), "VERIFIED\n(?!.*is unique)")
    none = changed(good, sin2_half_angle=None)
    yield Case("unique alone", told(none), f"REFUSED: {UNIQUE}$")
    yield Case("no angle", told(changed(none, unique=False)), "VERIFIED\n(?!.*degrees)")
    zero = changed(good, sin2_half_angle=[0, 0], unique=False)
    yield Case("angle 0", told(zero), f"REFUSED: {ANGLE}$")
    for number in ([0, 0], [-1, 0]):
        yield Case(f"mu {number}", told(changed(good, mu=number)), f"REFUSED: {ANGLE}$")
    below = changed(good, mu=[-1000, 0], sin2_half_angle=[-1, 0], unique=False)
    yield Case("mu and angle below 0", told(below), f"REFUSED: {ANGLE}$")
    for delta in (48, 49):  # 6 n units are rounded away
        least = changed(good, mu=[1, 0], sin2_half_angle=[delta, -64])
        answer = "VERIFIED" if delta > 48 else f"REFUSED: {ANGLE}$"
        yield Case(f"delta {delta}", told(least), answer)
    for number in ([0, 0], [-1, -20]):
        asked = told(changed(good, gap=number))
        yield Case(f"gap {number}", asked, f"REFUSED: {RANGE}$")
    yield Case("pose 0", told(good | {"pose": [0] * 4}), f"REFUSED: {RANGE}$")
    yield Case("long pose", told(good | {"pose": [-(2**255), 0, 0, 0]}), "VERIFIED")
    longest = told(good | {"pose": [2**256, 0, 0, 0]})
    yield Case("longer pose", longest, f"REFUSED: {RANGE}$")


def _least_sine(excess: Fraction, mu: Fraction) -> Fraction:
    """The least s of mu: in the plane of the axis z, where c is 0 along e_0 and 416 along e_3.

    c - (excess + mu (1 - s)) I + mu u u^T > 0 there, u = (50, 1) / sqrt(2501); the other two axes
    have 320 and 160, which are larger.
    """
    low, high = Fraction(0), Fraction(1)
    a, b, c = mu * 2500 / 2501, mu * 50 / 2501, mu / 2501 + 416
    for _ in range(80):
        s = (low + high) / 2
        level = excess + mu * (1 - s)
        proved = a > level and (a - level) * (c - level) > b * b
        low, high = (low, s) if proved else (s, high)
    return high


def _labels() -> Iterator[Case]:
    good = document()
    for labels in ("1111110", "111111000", "1111112", "1111110 ", "", "111111"):
        asked = told(changed(good, labels=labels))
        wrong = len(labels) != 8 or set(labels) - set("10?")
        yield Case(f"labels {labels!r}", asked, f"REFUSED: {LABELS}$" if wrong else "")
    for k in range(8):
        true = "11111100"
        for label in "10?":
            claimed = true[:k] + label + true[k + 1 :]
            asked = told(changed(good, labels=claimed, **OPEN))
            yield Case(f"label {claimed}", asked, "VERIFIED" if label in (true[k], "?") else MANY)
    some = told(changed(good, labels="1111110?"))
    yield Case("an angle of open labels", some, f"REFUSED: {ANGLE}$")
    for labels, right in {
        "??1??1": True,
        "111001": False,
        "001111": False,
        "????0?": False,
    }.items():
        tied = document(TWO * 2, TIED, [0.5] * 6, labels=labels, **OPEN) | {"pose": [1, 0, 0, 1]}
        yield Case(f"tied {labels}", told(tied), "VERIFIED" if right else MANY)
    near = document(TWO * 2, [*TIED[:3], [1 / 64, -2, 0], *TIED[4:]], [0.5] * 6, labels="111001")
    turned = near | {"pose": [1, 0, 0, 1], "claims": near["claims"] | OPEN}
    yield Case("nearly tied", told(turned), "VERIFIED")
    back = turned | {"pose": [1, 0, 0, -1], "claims": turned["claims"] | {"labels": "001111"}}
    yield Case("nearly tied, the other", told(back), MANY)
    for axis in range(3):  # the better rotation, half a turn, has this entry for its largest one
        half = [[k * (1.0 if j == axis else -1.0) + 0.0 for j, k in enumerate(x)] for x in AXES]
        two = document([*TWO, *AXES], [*TWO, *half], [0.5] * 9, labels="111000000", **OPEN)
        on_axis = [k for k, x in enumerate(AXES, 3) if x[axis]]
        labels = "".join("01"[k < 3 or k in on_axis] for k in range(9))
        yield Case(f"half a turn {axis}", told(changed(two, labels=labels)), MANY)
    bounds = [0.5, 0.25, 0.5, 1.0, 0.125, 0.5, 2.0, 9.0]
    yield Case("other bounds", told(document(bounds=bounds)), "VERIFIED")
    wide = changed(document(bounds=[0.5] * 7 + [20.0]), labels="11111101")
    yield Case("a pair that is always within", told(changed(wide, **OPEN)), "VERIFIED")
    yield Case("few tests", told(good, TESTS_MAX=500), MANY)
    yield Case("few halvings", told(good, HALVINGS=3), MANY)


def _data() -> Iterator[Case]:
    good = document()
    yield Case("all pairs", told(good, PAIRS_MAX=8), "VERIFIED")
    yield Case("too many pairs", told(good, PAIRS_MAX=7), "REFUSED: more than 7 pairs$")
    for k in (0, 7):
        weights = [1.0 + (j == k) * 2.0**-52 for j in range(8)]
        asked = told(document(weights=weights))
        yield Case(f"weight {k}", asked, "REFUSED: a weight is not 1$")
        for bound in (0.0, -0.5):
            bounds = [bound if j == k else 0.5 for j in range(8)]
            asked = told(document(bounds=bounds))
            yield Case(f"bound {k} {bound}", asked, "REFUSED: a bound is not positive$")
    tiny = [[k * 2.0**-900 for k in row] for row in AXES]
    scaled = document(tiny, tiny, [2.0**-901] * 6, labels="111111")
    yield Case("in another unit", told(scaled), "VERIFIED")


def _worth() -> Iterator[Case]:
    """Numbers of worth, and the words that tell them."""
    off = changed(document(), gap=[1, 0], **OPEN) | {"pose": [50, 0, 0, 1]}
    cost = 2 + Fraction(416, 2501)

    def near(name: str, exact: Fraction) -> Any:
        def ask(checker: Any) -> bool:
            value = getattr(checker.check(oracle.dump(off)).worth, name)
            return 0 <= value - exact < Fraction(1, 2**57)

        return value_of(ask)

    yield Case("objective", near("objective", cost), "True$")
    yield Case("weight", near("weight", Fraction(8)), "True$")
    yield Case("gap", near("gap", Fraction(1)), "True$")
    yield Case("minimum", near("minimum", cost - 1), "True$")

    def numbers(checker: Any) -> Any:
        worth = checker.check(oracle.dump(off)).worth
        return 0 <= worth.length**2 - Fraction(1, 8) < Fraction(1, 2**50), worth.angle

    yield Case("length and no angle", value_of(numbers), r"\(True, None\)$")

    up = [[0.0, 0.0, 5.0], [0.0, 0.0, -5.0]]
    along = changed(document((*AXES, *up), (*AXES, *up[::-1])), gap=[1, 0], **OPEN)

    def share_of_another(checker: Any) -> bool:
        found = checker.check(oracle.dump(along)).worth.share  # 6 by half a turn about z, less 2
        return 0 <= found * 4 - 1 < Fraction(1, 2**50)

    yield Case("share by the last axis", value_of(share_of_another), "True$")

    def least_share(checker: Any) -> bool:
        wide = 6 - cost  # by half a turn about x two of eight stay within
        found = checker.check(oracle.dump(off)).worth.share
        return 0 <= found * wide - 1 < Fraction(1, 2**50)

    yield Case("share", value_of(least_share), "True$")
    words = (
        r"VERIFIED\nData: n = 8 pairs.*\nThe cost of R is at most 2.16633346662, less than 1.0e\+0 "
        r"above the global minimum, which is at least 1.16633346661.\nAt every global optimum "
        r"within their bounds are 6 pairs: rows 0, 1, 2, 3, 4, 5 \(from 0\).\nAt every global "
        r"optimum NOT within their bounds are 2 pairs: rows 6, 7 \(from 0\).\nPairs of which that "
        r"is not proved: 0.\nNot proved"
    )
    yield Case("words", told(off), words)
    angle = (
        "VERIFIED\n.*Every global optimum is within 1.2e-1 degrees of R.\nThe global optimum is uni"
    )
    yield Case("angle in words", told(document()), angle)
