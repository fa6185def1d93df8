"""The trusted checker of certreg: one file, standard library only, exact integer arithmetic.

    python3 -I -S verify.py [--max-angle RAD] [--max-gap SHARE] [--max-undecided K] certificate.json

prints the theorems proved of the data, then VERIFIED or REFUSED and why; of a .jsonl file, with a
certificate a line, the refused lines and a total (exit code 0 or 1; 2: unreadable file or usage).
All is computed anew from the points: what a certificate holds is never believed. No float decides.

Pairs x_i (source), y_i (target), weights w_i >= 0, M = sum w_i > 0; C = sum w_i y_i x_i^T and
S2 = sum w_i x_i x_i^T, both less the weighted means; J = tr(S2) I - S2; quaternions (w, x, y, z).
The objective of R is min over t of sum w_i |y_i - R x_i - t|^2 = constant - 2 tr(R^T C).
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import struct
import sys
from array import array
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import cache, partial
from getopt import GetoptError, gnu_getopt
from itertools import accumulate, chain, combinations_with_replacement, product, repeat
from math import factorial, frexp, gcd, isfinite, isqrt, ldexp, prod
from operator import add, itemgetter, mul, ne, neg
from pathlib import Path
from typing import Any, BinaryIO, ClassVar, Protocol

Matrix = list[list[int]]
Limits = Mapping[str, Fraction]
Telling = Callable[[], Iterable[str]]  # theorems, written when they are asked for
TYPES: dict[str, type] = {"int": int, "bool": bool, "str": str}  # else it is of so many integers:
SUMS: dict[bytes, Any] = {}  # of other data, by prefix: doubles a pair, their sums, what to give
LENGTHS = {"Fraction": (2,), "tuple[int, int, int, int]": (4,), "tuple[int, ...]": range(5)}
FORMAT = "certreg-certificate/1"
INLINE_MAX, FILE_MAX = 10**6, 10**8  # points in a certificate, 75 MB in base64; its bytes
NODES_MAX = 50_000  # commas and brackets; each costs less than 600 bytes of memory: < 30 MB
DIGITS_MAX, EXPONENT_MAX = 4300, 32768  # of an integer, as Python's own limit; of a dyadic
PIPES = ("/dev/fd/", "/dev/stdin", "/proc/self/fd/")  # where a shell puts the ends of its own
LIMITS = {"max-angle": "angle", "max-gap": "share", "max-undecided": "undecided"}  # what they limit
BLOCK, NEAR = 8192, 128  # points split at a time; exponents so far apart are made the same
PRIME, BITS, DEGREES = 2**31 - 1, 256, Fraction("57.295779514")  # in a radian: 180/pi = ...513...


class RefusalError(Exception):
    """The certificate does not prove what it claims; the message says what is wrong."""


@dataclass(frozen=True, repr=False)  # of so many digits
class Worth:
    """What is proved of a pose, in numbers: exact, or bounds to about twenty digits."""

    weight: Fraction  # the sum of all
    objective: Fraction  # at R
    minimum: Fraction  # the global one is at least this
    gap: Fraction  # the objective at R exceeds it by less
    length: Fraction  # > sqrt(gap / weight)
    share: Fraction  # the gap is less of the range of the objective; 0 where that is 0
    angle: Fraction | None  # in radians, < pi: from R to any optimum it is less; None: unbounded


@dataclass(frozen=True)
class Outcome:
    """What `check` found: theorems in words with numbers, or else the reason for refusing."""

    verified: bool
    reason: str = ""
    undecided: int | None = None  # pairs of which no label is claimed; None: none has a label
    # Found and written when they are read:
    weigh: Callable[[], Worth | None] = field(default=type(None), compare=False, repr=False)
    tell: Telling = field(default=tuple, compare=False, repr=False)

    @property
    def worth(self) -> Worth | None:
        """Of the pose, if the certificate is about one and is verified."""
        return self.weigh()

    @property
    def theorems(self) -> tuple[str, ...]:
        """What is proved, in words."""
        return tuple(self.tell())


@dataclass(frozen=True)
class Clouds:
    """Points that a certificate must be about: 3n, 3n and n numbers; row i pairs with row i."""

    source: tuple[float, ...] | array[float]
    target: tuple[float, ...] | array[float]
    weights: array[float] | None = None  # or factors, 6n numbers; None: all are 1
    model: str = ""  # as that of a Statement
    any_weight: bool = False  # without weights: all are equal, as in the certificate


class Statement(Protocol):
    """A well-formed certificate: each kind is a dataclass of entries, read by names and types."""

    kind: ClassVar[str]
    keys: ClassVar[dict[str, str]]  # as `entries_of` takes them; `about` is never read
    prefix: ClassVar[bytes] = b"certreg-problem/1\0"  # of what the digest is taken of
    model: ClassVar[str] = ""  # what is to be asked for of clouds, to state the same problem
    n: int  # of points
    digest: str  # what binds them
    data: str | None  # perhaps themselves

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """Theorems about points with these sums; RefusalError if a claim does not follow."""
        ...


def require(condition: object, reason: str, *of: object) -> None:
    """Nothing if the condition holds; otherwise RefusalError, the reason filled in only then."""
    if not condition:
        raise RefusalError(reason.format(*of) if of else reason)


def check(certificate: bytes, clouds: Clouds | None = None, limits: Limits = {}) -> Outcome:  # noqa: B006  (only read)
    """Theorems that the certificate proves of its points, or why it is refused; never raises."""
    try:
        stated = parse(certificate)
        del certificate  # as large as the points
        doubles = bound_doubles(stated, clouds)
        equal = bytes(doubles[-8 * stated.n :]) == bytes(doubles[-8:]) * stated.n  # weights
        sums = SUMS.get(stated.prefix, (1, moments))[1](doubles, stated.n)
        return within(stated.prove(*sums, equal=equal), limits)
    except (RefusalError, MemoryError, RecursionError) as error:
        return Outcome(verified=False, reason=str(error) or "not enough memory")


def within(outcome: Outcome, limits: Limits) -> Outcome:
    """The outcome; RefusalError where it has no such bound, or one above the limit."""
    for name, limit in limits.items():
        known = outcome if name == "undecided" else outcome.worth
        bound, unit = getattr(known, name, None), " rad" * (name == "angle")
        degrees = f" ({rounded(bound * DEGREES, 3):.2e} degrees)" if bound and unit else ""
        proved = "none" if bound is None else f"{rounded(bound, 3):.2e}{unit}{degrees}"
        told = f"proved bound on the {name}: {proved}; asked for: {rounded(limit, 17):g}{unit}"
        if known is outcome:
            told = f"undecided pairs: {'no labels' if bound is None else bound}; asked for: {limit}"
        require(bound is not None and bound <= limit, told)
    return outcome


def parse(text: bytes) -> Statement:
    """The certificate in a file, of any kind in KINDS."""
    nodes = sum(map(text.count, (b",", b"[", b"{")))
    require(len(text) <= FILE_MAX and nodes <= NODES_MAX, "the certificate is too large")
    try:
        document = JSON.decode(text.decode())
    except (ValueError, RecursionError) as error:
        raise RefusalError("the certificate is not JSON in UTF-8 of a sane depth") from error
    kind = document.get("kind") if document.__class__ is dict else None
    form: Any = next((form for form in KINDS.values() if form.kind == kind), IsotropicStatement)
    entries = entries_of(document, form.keys)
    known = document["about"].__class__ is dict and form.kind == kind
    require(known and document["format"] == FORMAT, f"not a {FORMAT} of a known kind")
    return form(*[entry(wanted, entries.get(wanted[0])) for wanted in typed(form)])


def entries_of(document: Any, keys: dict[str, str]) -> dict[str, Any]:
    """All entries by name. The document, under "", and objects in it have exactly the keys stated.

    A key that ends in ? may be missing. An object whose name does may be null: its entries are.
    """
    entries: dict[str, Any] = {}
    for place, words in keys.items():
        name, (known, needed) = place.rstrip("?"), named(words)
        absent = name != place and document.get(name) is None
        part: Any = dict.fromkeys(known) if absent else document[name] if name else document
        good = part.__class__ is dict and needed <= part.keys() <= known
        require(good, "{} must have exactly the keys {}", name or "the certificate", words)
        entries.update(part)
    return entries


@cache
def named(words: str) -> list[set[str]]:
    """The keys in words, and those of them that may not be missing."""
    known = {*words.replace("?", "").split()}
    return [known, known & {*words.split()}]


@cache
def typed(form: Any) -> list[tuple[str, str, bool]]:
    """Of the fields of a kind: name, type, and whether it may be None."""
    return [(f.name, str(f.type).removesuffix(" | None"), "|" in str(f.type)) for f in fields(form)]


def entry(wanted: tuple[str, str, bool], value: Any) -> Any:
    """The value of an entry, of the type that its field in a kind has; None where it may be."""
    name, kind, null = wanted
    if value.__class__ is TYPES.get(kind) or (null and value is None):
        return value
    require(kind in LENGTHS and value.__class__ is list, "{} is of a wrong type", name)
    good = len(value) in LENGTHS[kind] and {*map(type, value)} <= {int}
    require(good, "{} is not a list of integers of the right length", name)
    return _dyadic(*value) if kind == "Fraction" else tuple(value)


def _dyadic(number: int, exponent: int) -> Fraction:
    require(abs(exponent) <= EXPONENT_MAX, "an exponent is too large")
    return Fraction(number << exponent) if exponent >= 0 else Fraction(number, 1 << -exponent)


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    require(len(pairs) == len(found := dict(pairs)), "a key appears twice")
    return found


def _bounded(digits: str) -> int:
    require(len(digits) <= DIGITS_MAX, "an integer has more than {} digits", DIGITS_MAX)
    return int(digits)  # ValueError for NaN and Infinity


def bound_doubles(certificate: Statement, clouds: Clouds | None) -> memoryview:
    """Little-endian doubles source, target, weights or factors that the digest, SHA-256, binds.

    From the certificate, or from `clouds` where it holds none; where both are given, they agree.
    """
    n, text, content = certificate.n, certificate.data, b""
    require(1 <= n < 2**40, "n is out of range")
    head, own = certificate.prefix + struct.pack("<Q", n), SUMS.get(certificate.prefix, (1,))[0] * n
    size = len(head) + 48 * n + 8 * own
    if text is not None:
        require(n <= INLINE_MAX and len(text) == (size + 2) // 3 * 4, "data is not of n points")
        try:
            content = base64.b64decode(text, validate=True)
        except ValueError as error:
            raise RefusalError("data is not base64") from error
        last = base64.b64encode(content[(size - 1) // 3 * 3 :]).decode()  # where bits may be left
        good = content.startswith(head) and len(content) == size and text.endswith(last)
        require(good, "data is not canonical, or not of n points")
    require(content or clouds, "the certificate holds no points: give SOURCE and TARGET")
    if clouds:
        said = certificate.model or "neither --scale nor --rotation-only"
        require(clouds.model == certificate.model, f"the certificate has {said}: give the same")
        parts = [p for p in (clouds.source, clouds.target, clouds.weights) if p is not None]
        same = [len(part) for part in parts] == [3 * n, 3 * n, own][: len(parts)]
        ask = SUMS.get(certificate.prefix, (1, 0, "weights are unequal: give --weights FILE"))[2]
        require(same, f"the certificate is about another number of points or {ask.split()[0]}")
        numbers = array("d", map((0.0).__add__, chain(*parts)))  # 0.0 + -0.0 = 0.0
        if sys.byteorder == "big":
            numbers.byteswap()
        given, bare = head + numbers.tobytes(), clouds.weights is None
        content = content or given + struct.pack("<d", 1.0) * ((size - len(given)) // 8)
        same = content.startswith(given[: size - 8 * own])
        require(same, "the certificate is about other points")
        equal, (w,) = content[-8:] * own == content[-8 * n :], struct.unpack("<d", content[-8:])
        good = equal and (clouds.any_weight or w == 1) if bare else content.startswith(given)
        sigma = float(f"{w**-0.5:.6g}") if 1e-300 < w < 1e300 else 1.0
        option = f"--sigma {sigma}" if float(1 / Fraction(sigma) ** 2) == w else "--any-weight"
        told = f"the certified weight is {w!r}, not {'1' if bare else 'as given'}: give {option}"
        require(good, told if equal else f"the certified {ask}")
    digest = hashlib.sha256(content).hexdigest()
    require(digest == certificate.digest, "the digest is not theirs (weights not given are 1)")
    return memoryview(content)[len(head) :]


def moments(doubles: bytes | memoryview, n: int) -> tuple[Matrix, int]:
    """m, e: exactly sum w a_i a_j = m[i][j] 2^e if i = j or i < j, 4; a = (1, x1, x2, ..., y3)."""
    m, e = [[0] * 7 for _ in range(7)], 0
    for start in range(0, n, BLOCK):
        count = min(BLOCK, n - start)
        x, y = (_split(doubles, first, 3 * count) for first in (3 * start, 3 * (n + start)))
        own = bytes(doubles[8 * (6 * n + start) :][: 8 * count])
        w, g, low = _split(own, 0, 1 if own == own[:8] * count else count)
        require(min(w) >= 0, "a weight is negative")
        near, old, e = not any(chain(x[1], y[1], g)), e, min(e, low + 2 * min(0, x[2], y[2]))
        unit = w[0] if len(w) < count else 0  # as usual all are equal: taken out
        a = [([1] * count, [0] * count, 0)]
        a += [(k[i::3], s[i::3], p) for k, s, p in (x, y) for i in range(3)]
        for i, (left, s, p) in enumerate(a):
            loads = left if unit else [*map(mul, w, left)]
            shifts = s if near or unit else [*map(add, g, s)]
            for j, (right, t, q) in enumerate(a[i : 7 if i < 4 else i + 1], i):
                terms = right if unit and not i else map(mul, loads, right)
                total = sum(terms if near else map(int.__lshift__, terms, map(add, shifts, t)))
                m[i][j] = (m[i][j] << old - e) + (total * (unit or 1) << low + p + q - e)
    return m, e


def _split(doubles: bytes | memoryview, first: int, count: int) -> tuple[list[int], list[int], int]:
    """Integers k, s and low such that the doubles are k 2^(s + low); all s >= 0, or 0 if near."""
    values = struct.unpack_from(f"<{count}d", doubles, 8 * first)
    bits = struct.unpack_from(f"<{count}Q", doubles, 8 * first) if 0.0 in values else ()  # or -0.0
    require(all(map(isfinite, values)), "the data hold a number that is not finite")
    require(1 << 63 not in bits, "the data hold -0.0, which is not canonical")
    sizes = [*filter(None, map(abs, values))] or [0.0]  # 2^(e - 53) divides what has exponent e
    low, high = frexp(min(sizes))[1] - 53, frexp(max(sizes))[1] - 53
    if high - low <= NEAR:
        return list(map(int, map(ldexp, values, repeat(-low)))), [0] * count, low
    e = [frexp(v)[1] - 53 if v else low for v in values]
    return list(map(int, map(ldexp, values, map(neg, e)))), [k - low for k in e], low


def rounded(value: Fraction, digits: int, rounding: str = ROUND_CEILING) -> Decimal:
    """Least decimal number of so many digits that is at least the value >= 0; or the greatest."""
    return Context(prec=digits, rounding=rounding).divide(*map(Decimal, value.as_integer_ratio()))


def root_up(n: int, d: int) -> Fraction:
    """More than the root of n/d >= 0, by 2^-68 of it at most."""
    s = max(70 + (d.bit_length() - n.bit_length()) // 2, 0)
    return Fraction(isqrt((n << 2 * s) // d) + 1, 1 << s)


def shown(text: object) -> str:
    """Text from outside made printable: ASCII, escaped, of bounded length."""
    return ascii(str(text)[:200])[1:-1]


# --- part: command --------------------------------------------------------------------------------
# The exit code 1 is a verdict, and nothing else.


def main(argv: list[str]) -> int:
    """Exit code: 0 verified, 1 refused, 2 unreadable file, wrong usage or output not writable."""
    try:
        options, (path,) = gnu_getopt(argv, "", [f"{name}=" for name in LIMITS])
        limits = {LIMITS[name[2:]]: Fraction(repr(float(text))) for name, text in options}
        require(all(limit >= 0 for limit in limits.values()), "a limit is negative")
    except (GetoptError, ValueError, RefusalError):
        options = "[--max-angle RAD] [--max-gap SHARE] [--max-undecided K]"
        say(f"usage: verify.py {options} CERTIFICATE", 2)
        return 0 if argv == ["--help"] else 2
    good, total, text, many = 0, 0, b"", path.endswith(".jsonl")
    try:
        with opened(path) as file:
            read = file.readline if many else file.read  # of what is too long the end is not sought
            while len(text) <= FILE_MAX and ((text := read(FILE_MAX + 1)) or not (many or total)):
                total, good = total + 1, good + (outcome := check(text, limits=limits)).verified
                verdict = "VERIFIED" if outcome.verified else f"REFUSED: {outcome.reason}"
                if not (many and outcome.verified):
                    say("\n".join([*outcome.theorems, f"line {total}: " * many + verdict]))
    except (OSError, ValueError, MemoryError) as error:
        reason = shown(error) or "not enough memory"
        say(f"{shown(path)}: {reason}: give a readable file", 2)
        return 2
    if many:
        say(f"{good} of {total} certificates VERIFIED")
    return 0 if 0 < good == total else 1


def opened(path: str) -> BinaryIO:
    """A file that ends: regular, or a pipe that the shell made, as <(command)."""
    place = Path(path)
    if place.exists() and not (place.is_file() or path.startswith(PIPES)):
        raise OSError("a folder, a named pipe or a device")  # of which some never end
    return place.open("rb")


def say(words: str, number: int = 1) -> None:
    """Write lines on stdout or, 2, on stderr. Exits with 2 where stdout cannot be written.

    That its reader has left is no fault. What cannot be told on stderr is left out.
    """
    stream = (sys.stdout, sys.stderr)[number - 1]
    try:
        stream.write(words + "\n")
        stream.flush()
    except (AttributeError, OSError) as error:  # it is None where it was closed
        os.dup2(os.open(os.devnull, os.O_WRONLY), number)  # where Python writes the rest at its end
        if number == 1 and not isinstance(error, BrokenPipeError):
            say(f"the output cannot be written ({getattr(error, 'strerror', 'it is closed')})", 2)
            raise SystemExit(2) from None


# --- end of part: command -------------------------------------------------------------------------


# --- part: definite -----------------------------------------------------------------------------
# For kinds that rest on a matrix that is positive definite.


def positive_definite(rows: Matrix, last: int = 1) -> bool:
    """Whether a symmetric matrix, rows from the diagonal on, is so: all leading minors p > 0."""
    (p, *right), *rows = rows  # Sylvester; Bareiss: divisions by the last minor are exact
    B = [[(p * a - right[i] * b) // last for a, b in zip(r, right[i:])] for i, r in enumerate(rows)]
    return p > 0 and (not B or positive_definite(B, p))


def definite(A: Matrix, bits: int = BITS) -> bool:
    """Whether A, symmetric, at most 4x4, is positive definite: by its leading bits if these tell.

    A = 2^s B + E, 0 <= E_ij < 2^s, so |p^T E p| <= 4 2^s |p|^2: if B - 4 I > 0 then A > 0.
    """
    s = max(max(chain(*A)).bit_length() - bits, 0)
    B = [[(a >> s) - 4 * (j == 0 < s) for j, a in enumerate(r[i:])] for i, r in enumerate(A)]
    return positive_definite(B) or (s > 0 and definite(A, 2 * bits))


# --- end of part: definite ----------------------------------------------------------------------
# --- part: spectrum -----------------------------------------------------------------------------
# What is proved of the eigenvalues of K, for kinds that are about K.


def cross(m: Matrix) -> Matrix:
    """C over 2^e/M', from a table of moments over 2^e with the sum of the weights m[0][0] = M'."""
    return [[m[0][0] * m[j][k] - m[0][j] * m[0][k] for j in (1, 2, 3)] for k in (4, 5, 6)]


def davenport(C: Matrix) -> Matrix:
    """4x4 matrix K of the 3x3 matrix C: symmetric, q^T K q = tr(R(q)^T C) for unit q."""
    (a, b, c), (d, e, f), (g, h, i) = C
    s, t, u, x, y, z = b + d, c + g, f + h, h - f, c - g, d - b
    return [[a + e + i, x, y, z], [x, a - e - i, s, t], [y, s, e - a - i, u], [z, t, u, i - a - e]]


def quadratic(A: Matrix, v: Sequence[int]) -> int:
    """The form v^T A v."""
    return sum(map(mul, v, [sum(map(mul, row, v)) for row in A]))


def spreads(m: Matrix) -> list[int]:
    """Of the source and of the target, sum w_i |x_i|^2 less the means, over the unit of C."""
    return [sum([m[0][0] * m[k][k] - m[0][k] ** 2 for k in (i, i + 1, i + 2)]) for i in (1, 4)]


def proves_level(
    K: Matrix, unit: int, q: Sequence[int], level: int, mu: int, bits: int = BITS
) -> bool:
    """Whether A = level I - K + mu u u^T > 0; u = q/|q|, K is over 1/unit, level over |q|^2.

    Where it is, mu >= 0 and level = v + delta - mu, v = u^T K u, every unit quaternion p satisfies
        p^T K p - v < delta - mu (1 - (u.p)^2).                                              (*)
    Gap: objective(R(u)) - objective(R(p)) = 2 (p^T K p - v) < 2 delta.
    Angle: let p be optimal, 0 <= p^T K p - v, and R(u), R(p) be an angle a apart, so that
    1 - (u.p)^2 = sin^2(a/2): sin^2(a/2) < delta/mu if mu > 0.
    Unique if delta <= mu: were the largest eigenvalue of K double, its eigenspace would hold a
    unit p orthogonal to u, for which (*) says p^T K p < v + delta - mu <= v: not the largest.
    With mu = 0 every p^T K p < level: the gap is below 2 (level - v), the dual's own bound.
    """
    n, along = sum(map(mul, q, q)) * unit, [mu * c for c in q]
    A = [[a * b - n * k for b, k in zip(q, row)] for a, row in zip(along, K)]
    for i, row in enumerate(A):
        row[i] += level
    return definite(A, bits)


def proves_separation(K: Matrix, unit: int, q: Sequence[int], level: int) -> bool:
    """Whether p^T K p < level / |q|^2 for every unit p orthogonal to q; K is over 1/unit.

    With level = (v - g) |q|^2, v = q^T K q / |q|^2, g > 0: the second eigenvalue of K is at most
    the greatest p^T K p across q (Courant, Fischer), so below v - g <= the first - g. Any mu proves
    it; all eigenvalues are within 4 max |K_ij| of 0, and q is nearly an eigenvector.
    """
    return proves_level(K, unit, q, level, 32 * max(map(abs, chain(*K))) * unit, 64)


def multiplicities(C: Matrix) -> list[int]:
    """Multiplicities of the eigenvalues of K, from the largest on; a factor > 0 of C is no matter.

    Let d1 >= d2 >= |d3| be the singular values of C, d3 with the sign of D = det C. K has the
    eigenvalues d1+d2+d3, d1-d2-d3, -d1+d2-d3, -d1-d2+d3: neighbours coincide where d2 = -d3,
    d1 = d2, d2 = d3. e1, e2, e3 are the symmetric functions of the d_i^2, eigenvalues of C^T C;
    two of these coincide where the discriminant is 0, and s = 2 (b - a)^3 for (a, a, b).
    """
    for A in ([[entry % PRIME for entry in row] for row in C], C):  # if not 0 modulo PRIME, not 0
        (a, b, c), (d, e, f), (g, h, i) = A
        p = [a, b, c, d, e, f, g, h, i]
        q = [e * i - f * h, f * g - d * i, d * h - e * g]
        q += [c * h - b * i, a * i - c * g, b * g - a * h]
        q += [b * f - c * e, c * d - a * f, a * e - b * d]
        D = a * q[0] + b * q[1] + c * q[2]
        e1, e2, e3 = sum(map(mul, p, p)), sum(map(mul, q, q)), D * D  # by minors: Cauchy, Binet
        square = e1**2 * e2**2 - 4 * e2**3 - 4 * e1**3 * e3 + 18 * e1 * e2 * e3 - 27 * e3**2
        if square % PRIME or (A is C and square):
            return [1, 1, 1, 1]
    if e2 == 0:
        return [2, 2] if e1 else [4]
    s = 2 * e1**3 - 9 * e1 * e2 + 27 * e3
    if s == 0:
        return [1, 3] if D > 0 else [3, 1]
    return [1, 2, 1] if s < 0 else [1, 1, 2] if D > 0 else [2, 1, 1]


def inertia(m: Matrix) -> Matrix:
    """J over the same."""
    S = [[m[0][0] * m[j][k] - m[0][j] * m[0][k] for k in range(j, 4)] for j in (1, 2, 3)]
    (a, b, c), (d, e), (f,) = S
    return [[d + f, -b, -c], [-b, a + f, -e], [-c, -e, a + d]]


# --- end of part: spectrum ----------------------------------------------------------------------
# --- part: radius -------------------------------------------------------------------------------
# Claims, beside those of a kind: how far points may move before an optimum turns by an angle.

SLACK = 1 - Fraction(1, 2**60)  # `root_up` times this is less than the root


@dataclass(frozen=True)
class Movable:
    """The entries of `radius`, null where it is not claimed: s = sin(a/2) < 1 of an angle a.

    If every target point is off by less than `target`, or every point of both clouds by less than
    `both`, every optimum of the moved points is within a of R. Weights stay.
    """

    both: Fraction | None
    separation: Fraction | None  # of two eigenvalues, where the kind has any
    sin_half_angle: Fraction | None
    target: Fraction | None

    def radii(self) -> tuple[Fraction, Fraction, Fraction]:
        """sin_half_angle, target and both."""
        s, target, both = self.sin_half_angle, self.target, self.both
        if s and target and both:
            least, (n, d) = min(s.numerator, target.numerator, both.numerator), s.as_integer_ratio()
            if least > 0 and 2 * n * n <= d * d:
                return s, target, both
        raise RefusalError("radius is not of an angle up to 90 degrees, or not positive")

    def steady(self, keeps: Callable[[Fraction, Fraction], bool]) -> Telling:
        """The claim in words, if keeps(x, y) proves it of source and target points off by so much.

        Of all that are off by less, too.
        """
        s, target, both = self.radii()
        proved = keeps(Fraction(0), target) and keeps(both, both)
        require(proved, "radius is larger than what is proved")
        return partial(self._steady, s, target, both)

    def _steady(self, s: Fraction, target: Fraction, both: Fraction) -> Iterator[str]:
        degrees = f"within {rounded(angle_above(s) * DEGREES, 4):g} degrees of R"
        one, other = (f"{rounded(r, 3, ROUND_FLOOR):g}" for r in (target, both))
        but = "That is sufficient, not necessary; weights and matrices stay."
        yield f"If every target point is off by less than {one}, every optimum is {degrees}."
        yield f"So it is if every point of both clouds is off by less than {other}. {but}"

    def steady_by_growth(
        self, mu: Fraction, delta: Fraction, f: Fraction, *w: Fraction
    ) -> list[str]:
        """The claim, if there is one, in words; f(R) and (+) with mu and delta as in `settled`.

        w: the sum of w_i, and that of w_i |x_i - mean|^2; each w_i at least what W_i has of largest
        eigenvalue. With residuals L^T (y - S x) less their part that a shift takes away, r(S), f is
        |r|^2, and |r(S) - r(R)| <= 2 s k, k^2 = sum w |x - mean|^2, s = sin of half the angle a of
        S from R. Moved points add h - g(S) to r(S), |h| <= Y, |g| <= X, |g(S) - g(R)| <= 2 s X. So
        the moved f(S) - f(R) exceeds (mu - 8 k X) s^2 - 4 s (k (X + Y) + X (sqrt(f(R)) + X + Y)) -
        delta, which, negative at s = 0 and convex, stays positive from the s on where it is.
        Or by roots: those of f(S), f(R) move by m = X + Y at most, so the moved f(S) is larger if
        f(S) > (sqrt(f(R)) + 2 m)^2, and that it is if mu s^2 >= delta + 4 m (sqrt(f(R)) + m).
        """
        if (self.both, self.sin_half_angle, self.target) == (None, None, None):
            return []
        s, (weight, k, fit) = self.radii()[0], [root_up(*x.as_integer_ratio()) for x in (*w, f)]

        def keeps(dx: Fraction, dy: Fraction) -> bool:
            X, Y = dx * weight, dy * weight
            steep, slope = mu - 8 * k * X, 4 * (k * (X + Y) + X * (fit + X + Y))
            by_roots = mu * s * s >= delta + 4 * (X + Y) * (fit + (X + Y))
            return by_roots or (steep > 0 and (steep * s - slope) * s >= delta)

        return [*self.steady(keeps)()]


def room_of_eigenvector(g: Fraction, angle: Fraction, s: Fraction) -> Fraction:
    """How large sum w (|y||dx| + |dy||x| + |dx||dy|) may be, all about the means: a bound.

    If it is at most this, every optimum stays within a of R, s = sin(a/2), a <= 90 degrees.
    g: the largest eigenvalue of K is alone by more. angle: from R to the optimum, at most.
    K is linear in C, and the K of b c^T has the eigenvalues |b||c| and -|b||c|, twice each. So the
    new K is the old plus D, |D| at most that sum. Along K + t D, 0 <= t <= 1, the largest
    eigenvalue is alone by g - 2 |D| > 0 (Weyl), its line turns continuously, by phi, and
    sin(2 phi) <= 2 |D| / g < 1 (Davis, Kahan): the rotation turns by 2 phi < 90 degrees. And
    sin(a - b) >= sin a - b for 0 <= b <= a, so that g (sin a - angle) / 2 is enough.
    """
    return g * (sine_below(s) - angle) / 2


def angle_above(s: Fraction) -> Fraction:
    """More than the angle a of s = sin(a/2), at most 90 degrees, by its series."""
    n, d = s.as_integer_ratio()  # 2 s + s^3 / 3 + (3 / 20) s^5 / (1 - s^2):
    c = d * d - n * n
    return Fraction((120 * d * d * c + 20 * n * n * c + 9 * n**4) * n, 60 * d**3 * c)


def sine_below(s: Fraction) -> Fraction:
    """Less than sin a of s = sin(a/2) < 1."""
    n, d = s.as_integer_ratio()
    return Fraction(2 * n * isqrt((d * d - n * n << 140) - 1), d * d << 70)


# --- end of part: radius ------------------------------------------------------------------------
# --- part: rotation -----------------------------------------------------------------------------
# For kinds that are about C alone, and of which the problem may be one without a translation.

SETS = ("", "one rotation", "a circle", "a projective plane", "all rotations")


@dataclass(frozen=True)
class Modelled(Statement):
    """With rotation_only true, t = 0: then sums, C, S2 and J are taken about the origin.

    Centred sums are sum w a_i a_j - sum w a_i sum w a_j / M: with sums w a_i of 0 they are not.
    """

    rotation_only: bool | None

    @property
    def prefix(self) -> bytes:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Of one's own, so that no digest stands for two problems."""
        return b"certreg-rotation/1\0" if self.rotation_only else Statement.prefix

    @property
    def model(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Of one's own, too."""
        return "--rotation-only" if self.rotation_only else ""

    def about(self, m: Matrix) -> Matrix:
        """The table of moments; about the origin where there is no translation."""
        require(m[0][0] >= 1, "no weight is positive")
        return [[m[0][0], *[0] * 6], *m[1:]] if self.rotation_only else m


@dataclass(frozen=True)
class RotationStatement(Movable, Modelled):
    """What is claimed of a rotation R that is optimal up to proved bounds, by `proves_level`."""

    n: int
    unique: bool
    data: str | None
    digest: str
    pose: tuple[int, int, int, int]  # a quaternion of any length; R is its rotation
    pattern: tuple[int, ...]
    delta: Fraction
    gap: Fraction
    mu: Fraction
    sin2_half_angle: Fraction | None

    def require_optimal(self, K: Matrix, unit: int, delta: int, mu: int) -> int:
        """The level of `proves_level`; RefusalError where that or the angle is not proved."""
        norm, angle = sum(map(mul, self.pose, self.pose)), self.sin2_half_angle
        level = quadratic(K, self.pose) * unit + (delta - mu) * norm
        good = proves_level(K, unit, self.pose, level, mu)
        require(good, "delta and mu do not prove the pose optimal")
        bounded = angle is None or angle.numerator * mu >= delta * angle.denominator  # delta > 0
        require(bounded, "claims.sin2_half_angle is below the proved bound delta/mu")
        return level

    def require_pattern(self, true: list[int]) -> None:
        """RefusalError where `pattern` is not the true one, or not that of one optimum."""
        good = list(self.pattern) == true
        require(good, "claims.pattern is wrong, the true one is {}", true)
        require(true[0] == 1 or not self.unique, "claims.unique is wrong: it is not unique")

    def steady_by_separation(
        self,
        K: Matrix,
        unit: int,
        one: int,
        weight: Fraction,
        *spreads: int,
        angle: Fraction | None,
    ) -> Telling:
        """The claim, if there is one, in words. One is worth `one`, K is over 1/unit of that.

        weight: M. spreads: S = sum w |x - mean|^2 of both clouds, over that unit: by Cauchy and
        Schwarz what `room_of_eigenvector` bounds is at most dx sqrt(M Sy) + dy sqrt(M Sx) +
        M dx dy. angle: from R to the optimum, at most.
        """
        if (self.both, self.sin_half_angle, self.target) == (None, None, None):
            return tuple
        g, q, (n, d) = self.separation or Fraction(0), self.pose, weight.as_integer_ratio()
        norm = sum(map(mul, q, q))
        level = quadratic(K, q) * unit * g.denominator - g.numerator * one * norm
        alone = proves_separation(K, unit * g.denominator, q, level)
        require(g.numerator > 0 and angle and alone, "radius.separation is not proved")
        room = room_of_eigenvector(g, angle or Fraction(0), self.radii()[0])
        x, y = (root_up(k * n * unit, d * one) for k in spreads)
        over = max(k.denominator for k in (weight, x, y, room))  # powers of two
        M, X, Y, most = (k.numerator * (over // k.denominator) for k in (weight, x, y, room))

        def keeps(dx: Fraction, dy: Fraction) -> bool:
            (a, b), (c, d) = dx.as_integer_ratio(), dy.as_integer_ratio()
            return (Y * d + M * c) * a + X * c * b <= most * b * d

        return self.steady(keeps)

    def head(self, *, equal: bool) -> Iterator[str]:
        """What the theorems are about, in words."""
        yield f"Data: n = {self.n} pair{'s'[self.n < 2 :]}, {'NOT '[4 * equal :]}all of one weight."
        yield f"SHA-256 of their doubles is {self.digest}."
        length = isqrt(sum(c * c for c in self.pose) << 128)
        unit = ", ".join(f"{(c << 64) / length:.12f}" for c in self.pose)
        yield f"The certified rotation R is that of the quaternion ({unit}), rounded here; w first."

    def reach(self, w: Worth) -> Iterator[str]:
        """What gap and angle are worth, in words."""
        if w.share >= 1:
            yield "This gap bounds nothing: the range of energies is not proved to be larger."
        else:
            share = f"{rounded(w.share, 2):.1e}"
            part = f"This gap is less than {share} of the range of energies, over all rotations."
            yield part if w.share else "The range of energies is 0: every rotation is optimal."
        if w.angle is not None:
            degrees = rounded(w.angle * DEGREES, 2)
            yield f"Every global optimum is within {degrees:.1e} degrees of R."
        elif w.share:  # else R is an optimum, as every rotation
            yield "No angle is bounded: nothing is proved of how far R is from an optimum."


def angle_bound(delta: int, mu: int) -> Fraction | None:
    """More than the angle a of sin^2(a/2) < s = delta/mu; None if not < pi.

    a/2 < tan(a/2) < sqrt(s/(1 - s)) if s < 1.
    """
    angle = root_up(4 * delta, mu - delta) if mu > delta else None
    return angle if angle and 10**8 * angle.numerator < 314159265 * angle.denominator else None


# --- end of part: rotation ----------------------------------------------------------------------
# --- kind: isotropic ----------------------------------------------------------------------------
# Claims: the pose is optimal up to proved bounds; which rotations are at equilibrium; where a body
# that moves from a given state ends.


@dataclass(frozen=True)
class IsotropicStatement(RotationStatement):
    """delta, mu, nu, quaternion, angular_velocity make the proof short; the rest is claimed."""

    kind: ClassVar = "isotropic"
    keys: ClassVar = {
        "": "about basin claims format kind optimality pose problem radius? rotation_only? sdp",
        "radius?": "both separation sin_half_angle target",
        "basin?": "angular_velocity quaternion",
        "sdp?": "nu",
        "claims": "basin gap pattern sdp_gap sin2_half_angle unique unstable",
        "optimality": "delta mu",
        "problem": "data digest n",
    }

    basin: bool | None  # whether a body in the following state ends at the optimum
    angular_velocity: tuple[int, int, int, int] | None  # three integers, the exponent of their unit
    quaternion: tuple[int, int, int, int] | None
    unstable: tuple[int, ...] | None
    nu: Fraction | None
    sdp_gap: Fraction | None

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """All claims, by the functions below; what these prove stands in their docstrings."""
        good = self.delta.numerator > 0 <= self.mu.numerator and any(self.pose)
        require(good, "delta > 0, mu >= 0 and a pose other than 0 needed")
        weight, q, norm = _dyadic(m[0][0], e), self.pose, sum(c * c for c in self.pose)
        m = self.about(m)
        zeros = [(k & -k).bit_length() - 1 for k in m[0] if k]  # not in another unit of length:
        z = min([zeros[0] // 2, *zeros[1:]])
        m = [[m[0][0] >> 2 * z, *[k >> z for k in m[0][1:]]], *m[1:]]  # C, J over the same 2^e/M'
        C, mass = cross(m), m[0][0]
        K, pattern = davenport(C), multiplicities(C)
        solid = len(pattern) > 2 or definite(inertia(m), 64)  # then C is of rank 2: J > 0
        numbers = self.delta, self.gap, self.mu, self.mu if self.nu is None else self.nu
        over = max([-e, *[x.denominator.bit_length() - 1 for x in numbers]])
        one, unit = mass << over, 1 << over + e  # numbers times one are integers, K / unit
        delta, gap, mu, nu = [x.numerator * (one // x.denominator) for x in numbers]
        level = self.require_optimal(K, unit, delta, mu)
        require(gap >= 2 * delta, "claims.gap is below the proved bound 2 delta")
        self._require_equilibria(pattern, solid=solid)
        v = level - (delta - mu) * norm  # over norm
        dual, sdp = self.nu is not None, self.sdp_gap
        require(not dual or proves_level(K, unit, q, nu * norm, 0), "sdp.nu bounds nothing")
        bounded = sdp is None or (dual and sdp * one * norm >= 2 * (nu * norm - v))
        require(bounded, "claims.sdp_gap is below the proved bound 2 (nu - v)")
        if self.basin:
            p, w = self.quaternion, self.angular_velocity
            least, J = Fraction(level, norm * unit), inertia(m)
            inside = solid and p and w and proves_basin(K, J, least, p, w)
            require(inside, "claims.basin is not proved of the state in basin")
        both, angle = spreads(m), angle_bound(delta, mu)
        steady = self.steady_by_separation(K, unit, one, weight, *both, angle=angle)
        weigh = partial(self._worth, weight, sum(both) * unit * norm - 2 * v, C, unit, one)
        tell = partial(self._words, weigh, pattern, steady, solid=solid, equal=equal)
        return Outcome(verified=True, weigh=weigh, tell=tell)

    def _worth(self, weight: Fraction, objective: int, C: Matrix, unit: int, one: int) -> Worth:
        """The objective is sum w (|x|^2 + |y|^2) - 2 v, x and y less their means.

        Range: 2 (l1 - l4), K having eigenvalues l1 >= ... >= l4. As tr K = 0, the sum of squares
        F^2 = sum K_ij^2 is 4 times their variance, at most (l1 - l4)^2 (Popoviciu): range >= 2 F,
        and F^2 = 4 sum C_ij^2.
        """
        delta, mu = (x.numerator * (one // x.denominator) for x in (self.delta, self.mu))
        norm, gap = sum(map(mul, self.pose, self.pose)), 2 * self.delta
        bits = max([k.bit_length() for k in chain(*C)])  # of which the first will do; F is over
        F = 2 * isqrt(sum([(abs(k) << BITS >> bits) ** 2 for k in chain(*C)]))  # 2^(bits - BITS)
        share = Fraction(delta << BITS, F * unit << bits) if F else Fraction(0)
        least = Fraction(max(objective - 2 * delta * norm, 0), one * norm)
        length = root_up(2 * delta * weight.denominator, one * weight.numerator)
        value, angle = Fraction(objective, one * norm), angle_bound(delta, mu)
        return Worth(weight, value, least, gap, length, share, angle)

    def _require_equilibria(self, true: list[int], *, solid: bool) -> None:
        self.require_pattern(true)
        unstable = [0, *accumulate(true[:-1])] if solid else None  # collinear: no dynamics
        good = self.unstable is None or list(self.unstable) == unstable
        require(good, "claims.unstable is wrong or unproved: proved is {}", unstable)

    def _words(
        self,
        weigh: Callable[[], Worth],
        pattern: list[int],
        steady: Telling = tuple,
        *,
        solid: bool,
        equal: bool,
    ) -> Iterator[str]:
        w = weigh()
        yield from self.head(equal=equal)
        mass, value = (f"{rounded(x, 12):g}" for x in (w.weight, w.objective))
        shift = "no translation" if self.rotation_only else "best translation"
        yield f"Sum of weights: {mass}; objective at R, {shift}: {value}; both rounded up."
        gap, size = (f"{rounded(x, 2):.1e}" for x in (w.gap, w.length))
        told = f"less than {gap} (sum of weight x squared distance)"
        yield f"The objective at R, {shift}, exceeds the global minimum by {told}."
        least = f"{rounded(w.minimum, 12, ROUND_FLOOR):g}"
        yield f"So the minimum is at least {least}; sqrt(gap / sum of weights) is below {size}."
        yield from self.reach(w)
        unique = "unique: every other rotation has a larger objective"
        several = f"NOT unique: the optima form {SETS[pattern[0]]}"
        yield f"The global optimum is {unique if pattern[0] == 1 else several}."
        sets = ", ".join(SETS[k] for k in pattern)
        counts = ", ".join(map(str, [0, *accumulate(pattern[:-1])]))
        three = (
            "two points not in line with the origin,"
            if self.rotation_only
            else "three noncollinear points"
        )
        if solid:
            yield f"The moving cloud has {three} of positive weight (J > 0)."
            yield f"The equilibria of the dynamics: {sets}; unstable directions: {counts}."
        else:
            line = "in line with the origin" if self.rotation_only else "collinear"
            yield f"The moving points are {line} (J is singular): the dynamics is not defined."
            yield f"The critical rotations: {sets}; directions of descent: {counts}."
        if self.sdp_gap is not None:
            void = ": nothing" if self.sdp_gap * w.share >= w.gap else ""  # above the range
            yield f"The relaxation's dual bounds that gap by {rounded(self.sdp_gap, 2):.1e}{void}."
        if self.basin:
            end = "ends at the optimum, whatever the damping > 0."
            yield f"A body moving from the state `basin` {end}"
        yield from steady()
        yield "Not proved: anything under `about`, and where the points come from."


def proves_basin(
    K: Matrix, J: Matrix, level: Fraction, p: Sequence[int], velocity: Sequence[int]
) -> bool:
    """Whether a body in the state (p, w), w its angular velocity, must end at the optimum; J > 0.

    E = w^T J w / 2 - 2 p^T K p, p a unit quaternion, never rises along the damped motion, which
    ends at an equilibrium (LaSalle). One that is not optimal has p^T K p at most the second
    eigenvalue of K, and by (*) that is < level = v + delta - mu, the bound across u. So
    p^T K p - w^T J w / 4 > level leaves only the optimum. K, J and level are over one unit.
    """
    *w, exponent = velocity
    spin = Fraction(quadratic(J, w), 4) * _dyadic(1, exponent) ** 2
    return any(p) and Fraction(quadratic(K, p), sum(c * c for c in p)) - spin > level


# --- end of kind: isotropic ---------------------------------------------------------------------
# --- kind: similarity ---------------------------------------------------------------------------
# Claims: a pose with a scale is optimal up to proved bounds, and where the best scale lies.

PREFIXES = {  # the four problems, by scale and rotation_only
    ("asymmetric", False): b"certreg-similarity/1\0",
    ("asymmetric", True): b"certreg-similarity-rotation/1\0",
    ("symmetric", False): b"certreg-similarity-symmetric/1\0",
    ("symmetric", True): b"certreg-similarity-symmetric-rotation/1\0",
}


@dataclass(frozen=True)
class SimilarityStatement(RotationStatement):
    """delta and mu make the proof short; the rest is claimed. Below, l1 is the largest eigenvalue.

    asymmetric: min of E = sum w |y - s R x - t|^2 over s >= 0, R, t. With best t it is Sy -
        2 s tr(R^T C) + s^2 Sx, so s = max(0, tr(R^T C)) / Sx is best: E = Sy - max(0, tr)^2 / Sx.
        K has trace 0, so l1 >= 0, and R is optimal iff tr(R^T C) = l1: the scale is l1 / Sx.
    symmetric: min of E = sum w |y - s R x - t|^2 / s over s > 0, R, t [Horn1987]: with best t it is
        Sy / s + s Sx - 2 tr(R^T C), so s = sqrt(Sy / Sx), whatever R: E = 2 sqrt(Sx Sy) - 2 tr.
    So optimal R are those without a scale. Proved by `proves_level`: v <= l1 < v + delta, v = tr at
    the certified R. The certified pose is R with the best s and t for it.
    """

    kind: ClassVar = "similarity"
    keys: ClassVar = {
        "": "about claims format kind optimality pose problem radius? rotation_only? scale",
        "radius?": "both separation sin_half_angle target",
        "claims": "gap pattern scale_lower scale_upper sin2_half_angle unique",
        "optimality": "delta mu",
        "problem": "data digest n",
    }

    scale: str
    scale_lower: Fraction
    scale_upper: Fraction

    @property
    def prefix(self) -> bytes:
        """Of the four problems, each its own; an unknown one is refused in `prove`."""
        return PREFIXES.get((self.scale, bool(self.rotation_only)), b"")

    @property
    def model(self) -> str:
        """Both options."""
        return f"--scale {shown(self.scale)}" + " --rotation-only" * bool(self.rotation_only)

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """All claims; what proves them stands above, in `proves_level` and in the parts."""
        q, delta, mu = self.pose, self.delta, self.mu
        require(self.prefix, "scale is neither asymmetric nor symmetric")
        require(delta > 0 <= mu and any(q), "delta > 0, mu >= 0 and a pose other than 0 needed")
        m, weight = self.about(m), _dyadic(m[0][0], e)
        C, (x, y) = cross(m), spreads(m)
        K, pattern, place = davenport(C), multiplicities(C), self._place()
        require(x > 0, f"all source points of positive weight are {place}: no scale is better")
        places = max(-e, *[k.denominator.bit_length() - 1 for k in (delta, mu)])
        one, unit = m[0][0] << places, 1 << places + e  # delta one, mu one are integers; K/unit
        d, u = (k.numerator * (one // k.denominator) for k in (delta, mu))
        self.require_optimal(K, unit, d, u)
        self.require_pattern(pattern)
        real = Fraction(unit, one)  # what 1 of K, x and y is worth
        v = quadratic(K, q) * real / sum(c * c for c in q)
        prove = self._asymmetric if self.scale == "asymmetric" else self._symmetric
        squares = sum([k * k for k in chain(*K)]) * real**2
        value, least, gap, share = prove(v, x * real, y * real, squares)
        length, angle = root_up(*(gap / weight).as_integer_ratio()), angle_bound(d, u)
        weigh = partial(Worth, weight, value, least, gap, length, share, angle)
        steady = self.steady_by_separation(K, unit, one, weight, x, y, angle=angle)
        tell = partial(self._words, weigh(), pattern, steady, equal=equal)
        return Outcome(verified=True, weigh=weigh, tell=tell)

    def _place(self) -> str:
        return "at the origin" if self.rotation_only else "at one point"

    def _asymmetric(
        self, v: Fraction, x: Fraction, y: Fraction, squares: Fraction
    ) -> list[Fraction]:
        """Objective at R, a bound of the minimum, the gap and its share; x = Sx, y = Sy.

        E(R) - min = (l1^2 - v^2) / Sx < delta (2 v + delta) / Sx if v >= 0; if not, that is false:
        with delta = 2 |v| it would be 0. The range of E over R is l1^2 / Sx: tr <= 0 somewhere. And
        l1^2 >= v^2, l1^2 >= F^2 / 12, F^2 = sum K_ij^2: the least is at (l1, l1, l1, -3 l1).
        """
        delta, most = self.delta, v + self.delta
        require(v >= 0, "tr(R^T C) < 0 at the certified R: there the best scale is 0")
        gap, size = delta * (v + most) / x, max(v * v, squares / 12)
        least = "delta (2 v + delta) / Sx"
        require(not self.gap < gap, f"claims.gap is less than the proved {least}")
        good = self.scale_lower * x <= v and self.scale_upper * x >= most
        require(good, "claims.scale_lower and scale_upper do not hold v / Sx and (v + delta) / Sx")
        share = gap * x / size if size else Fraction(0)
        return [y - v * v / x, max(y - most * most / x, Fraction(0)), gap, share]

    def _symmetric(
        self, v: Fraction, x: Fraction, y: Fraction, squares: Fraction
    ) -> list[Fraction]:
        """The same. E(R) - min = 2 (l1 - v) < 2 delta; range 2 (l1 - l4) >= 2 F as of `isotropic`.

        Popoviciu: F^2 is 4 times the variance of the eigenvalues, at most (l1 - l4)^2.
        """
        place, gap = self._place(), 2 * self.delta
        require(y > 0, f"all target points of positive weight are {place}: no scale is symmetric")
        require(gap <= self.gap, "claims.gap is less than the proved 2 delta")
        low, high = self.scale_lower, self.scale_upper
        good = (low <= 0 or low * low * x <= y) and high >= 0 and high * high * x >= y
        require(good, "claims.scale_lower and scale_upper do not hold sqrt(Sy / Sx)")
        most, share = root_up(*(x * y).as_integer_ratio()), Fraction(0)
        if squares:
            share = root_up(*(self.delta**2 / squares).as_integer_ratio())
        least = max(2 * (most * SLACK - v - self.delta), Fraction(0))
        return [2 * (most - v), least, gap, share]

    def _words(
        self, w: Worth, pattern: list[int], steady: Telling, *, equal: bool
    ) -> Iterator[str]:
        yield from self.head(equal=equal)
        shift, none = ("", ", no translation") if self.rotation_only else (" - t", "")
        over = " / s" if self.scale == "symmetric" else ""
        told = f"sum of weight x |y - s R x{shift}|^2{over}, s the scale{none}"
        yield f"The objective ({self.scale}): {told}."
        low, high = max(self.scale_lower, Fraction(0)), self.scale_upper
        ends = rounded(low, 17, ROUND_FLOOR), rounded(high, 17)
        yield f"The scale of every global optimum is at least {ends[0]:g} and at most {ends[1]:g}."
        if low:
            yield f"Relative to it, these bounds are {rounded(high / low - 1, 2):.1e} apart."
        mass, value = (f"{rounded(x, 12):g}" for x in (w.weight, w.objective))
        yield f"Sum of weights: {mass}; objective at R, best scale: {value}; both rounded up."
        gap, least = f"{rounded(w.gap, 2):.1e}", f"{rounded(w.minimum, 12, ROUND_FLOOR):g}"
        yield f"It exceeds the global minimum, which is at least {least}, by less than {gap}."
        yield from self.reach(w)
        unique = "unique: every other pose with a scale has a larger objective"
        several = f"NOT unique: {SETS[pattern[0]]} are optimal, with one scale"
        if pattern[0] < 4:
            several = f"NOT unique: the optimal rotations form {SETS[pattern[0]]}, with one scale"
        yield f"The global optimum is {unique if pattern[0] == 1 else several}."
        sets = ", ".join(SETS[k] for k in pattern)
        yield f"Rotations at which the objective, with the best scale, may be stationary: {sets}."
        yield from steady()
        yield "Not proved: anything under `about`, and where the points come from."


# --- end of kind: similarity --------------------------------------------------------------------
# --- part: rank ---------------------------------------------------------------------------------
# For kinds that count solutions by linear algebra.


def has_rank(rows: Matrix, wanted: int, modulus: int) -> bool:
    """Whether so many rows are seen to be independent modulo the modulus: then they are over Q.

    Every pivot has an inverse, so a minor is a unit modulo the modulus and is not zero; whether the
    modulus is a prime does not matter. A row is one long integer, an entry every `size` bytes: the
    entries stay below modulus + len(rows) modulus^2, so that none reaches the next.
    """
    size, pivots = (2 * modulus.bit_length() + len(rows).bit_length()) // 8 + 1, dict[int, int]()
    ends = range(size, size * len(rows[0]) + 1, size)

    def packed(row: Sequence[int]) -> int:
        parts = [(entry % modulus).to_bytes(size, "little") for entry in row]
        return int.from_bytes(b"".join(parts), "little")

    for entries in rows:
        row = packed(entries)
        for at, pivot in pivots.items():
            row += -((row >> at) % (1 << 8 * size)) % modulus * pivot
        data = row.to_bytes(ends[-1], "little")
        left = [int.from_bytes(data[end - size : end], "little") % modulus for end in ends]
        k = next((k for k, entry in enumerate(left) if gcd(entry, modulus) == 1), None)
        if k is not None:
            inverse = pow(left[k], -1, modulus)
            pivots[8 * size * k] = packed([entry * inverse for entry in left])
        if len(pivots) == wanted:
            return True
    return False


# --- end of part: rank --------------------------------------------------------------------------
# --- kind: count --------------------------------------------------------------------------------
# Claims: at most four rotations are at equilibrium. It is about the torque of the springs alone.

MODULUS_MAX = 2**64  # bounds the time; larger ones prove nothing more
PAIRS = [(i, j) for i in range(4) for j in range(i, 4)]  # the ten monomials q_i q_j


@dataclass(frozen=True)
class CountStatement(Statement):
    """chart, modulus: with which the quadratics are seen to be independent."""

    kind: ClassVar = "count"
    keys: ClassVar = {
        "": "about claims format kind problem proof",
        "claims": "at_most",
        "problem": "data digest n",
        "proof": "chart modulus",
    }

    n: int
    data: str | None
    digest: str
    at_most: int
    modulus: int
    chart: tuple[int, int, int, int]

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """The six torques of R(q) and the four q_i (a . q), a = chart, are quadratic forms in q.

        If their 10x10 coefficients are of full rank, every q_i q_j is a combination of the ten. At
        an equilibrium with a . q = 1 so every q_i q_j is a fixed combination of the q_i: the
        polynomials modulo the equations are spanned by four, and there are at most four solutions,
        complex ones and multiplicities counted. With a . q = 0 every q_i q_j, so q, would be 0. And
        q and -q, of which one at most has a . q = 1 when scaled, are the same rotation.
        """
        del equal  # of no matter here
        require(m[0][0] > 0, "no weight is positive")
        require(1 < self.modulus < MODULUS_MAX, "proof.modulus is out of range")
        independent = has_rank(coefficients(cross(m), self.chart), 10, self.modulus)
        require(independent, "proof does not show the quadratics independent")
        require(self.at_most >= 4, "claims.at_most is below the proved bound 4")
        theorems = (
            f"Data: n = {self.n} pairs. SHA-256 of their doubles is {self.digest}.",
            f"Sum of weights: {rounded(m[0][0] * _dyadic(1, e), 12):g}, rounded up.",
            "At most four rotations are at equilibrium: at all others the springs exert a torque.",
            "Complex solutions and multiplicities are counted in.",
            "Not proved: anything under `about`, and where the points come from.",
        )
        return Outcome(verified=True, tell=partial(tuple, theorems))


def coefficients(C: Matrix, chart: Sequence[int]) -> Matrix:
    """10x10: of the monomials in the order of PAIRS, in the six torques of R(q) and q_k (a . q)."""
    return [
        torques(rotation_coefficient(i, j), C)
        + [chart[j] * (i == k) + chart[i] * (j == k and i != j) for k in range(4)]
        for i, j in PAIRS
    ]


def rotation_coefficient(i: int, j: int) -> Matrix:
    """3x3 integer matrix: the coefficient of q_i q_j, i <= j, in |q|^2 R(q).

    |q|^2 R(q) = (w^2 - x^2 - y^2 - z^2) I + 2 v v^T + 2 w [v], v = (x, y, z), [v] u = v x u.
    """
    A = [[(i == j) * (1 if i == 0 else -1) * (a == b) for b in range(3)] for a in range(3)]
    if i > 0:
        A[i - 1][j - 1] += 2
        A[j - 1][i - 1] += 2 * (i != j)
    elif j > 0:
        a, b = j % 3, (j + 1) % 3  # [e_j] takes e_a to e_b
        A[b][a], A[a][b] = 2, -2
    return A


def torques(A: Matrix, C: Matrix) -> list[int]:
    """The six entries of A^T C - C^T A and A C^T - C A^T above the diagonal.

    For a rotation A = R they vanish iff the torque of the springs does: it is twice the first three
    in the body's frame, twice the last three in the world's, up to order and sign.
    """
    found: list[int] = []
    for one, other in ((list(zip(*A)), list(zip(*C))), (A, C)):
        product = [[sum(map(mul, row, column)) for column in other] for row in one]
        found += [product[i][j] - product[j][i] for i in range(3) for j in range(i + 1, 3)]
    return found


# --- end of kind: count -------------------------------------------------------------------------
JSON = json.JSONDecoder(object_pairs_hook=_unique, parse_int=_bounded, parse_constant=_bounded)
# --- part: springs ------------------------------------------------------------------------------
# Pair i has W_i = L_i L_i^T, L_i lower triangular, given by its six entries by rows. The energy at
# (R, t) is sum (y_i - R x_i - t)^T W_i (y_i - R x_i - t); the objective f of R is the least over t,
# or, with rotation_only true, that of t = 0: then means are taken for 0, as in the part rotation.
# At R(q), q of any length, it is F(q)/|q|^4, F a form of degree four. Weight: sum of tr W_i / 3.

Monomial = Six = tuple[int, ...]
LENGTHS.update(Six=(6,))
PRODUCTS: list[Monomial] = [*combinations_with_replacement(range(4), 2)]  # the ten q_i q_j
QUARTICS: list[Monomial] = [*combinations_with_replacement(range(4), 4)]  # F has 35 coefficients
SQUARE = [(1 + (a < c)) * (a == b and c == d) for a, b, c, d in QUARTICS]  # those of |q|^4
ROTATION = """+00+11-22-33 +12+12+03+03 +13+13-02-02 +12+12-03-03 +00-11+22-33 +23+23+01+01
    +13+13+02+02 +23+23-01-01 +00-11-22+33 +00+11+22+33"""  # |q|^2 R by columns, |q|^2
SPRINGS_KEYS = {
    "": "about claims format kind problem proof radius? rotation_only?",
    "radius?": "both sin_half_angle target",
    "claims": "gap sin2_half_angle unique",
    "problem": "data digest n",
}


@dataclass(frozen=True)
class SpringsStatement(Movable, Modelled):
    """What all these kinds state. The digest is of source, target, factors."""

    prefixes: ClassVar = b"certreg-springs/1\0", b"certreg-springs-rotation/1\0"
    n: int
    data: str | None
    digest: str
    pose: tuple[int, int, int, int]  # a quaternion of any length; R is its rotation
    gap: Fraction
    sin2_half_angle: Fraction | None
    unique: bool | None
    symmetry: Six | None  # with which unique is seen to be false

    @property
    def prefix(self) -> bytes:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Of one's own without a translation."""
        return self.prefixes[bool(self.rotation_only)]

    def springs(self, H: Matrix, e: int) -> CheckedSprings:
        """The objective, of `spring_moments`."""
        return CheckedSprings.of(H, e, moves=not self.rotation_only)


def spring_moments(doubles: bytes | memoryview, n: int) -> tuple[Matrix, int]:
    """Rows of H from its diagonal on, e: the energy is 2^e z^T H z, z = (t, R by columns, 1)."""
    total, low = [[0] * k for k in range(13, 0, -1)], 0
    for first in range(0, n, BLOCK):
        count = min(BLOCK, n - first)
        (x, y), p = _integers(doubles, [3 * first, 3 * (n + first)], 3 * count, 0)
        (factors,), g = _integers(doubles, [6 * (n + first)], 6 * count, EXPONENT_MAX)
        H, e, high = _energy([1 << -p] * count, x, y, factors), 2 * (g + p), low
        low = min(e, high)
        for old, new in zip(total, H):
            old[:] = [(i << high - low) + (j << e - low) for i, j in zip(old, new)]
    return total, low


def _integers(d: bytes | memoryview, firsts: list[int], n: int, high: int) -> tuple[Matrix, int]:
    """So many doubles from each first one on as integers times 2^e, e <= high."""
    parts = [_split(d, first, n) for first in firsts]
    low, most = min(high, *[e for _, _, e in parts]), max(max(s) + e for _, s, e in parts)
    require(most - low <= 3 * BITS, "the data hold numbers of too many sizes")
    return [[k << s + e - low for k, s in zip(ks, shifts)] for ks, shifts, e in parts], low


def _energy(one: list[int], x: list[int], y: list[int], factors: list[int]) -> Matrix:
    """H of integers: sum of r^T W r, r = y - R x - t one."""

    def plus(*terms: tuple[list[int], list[int]]) -> list[int]:
        return [*map(sum, zip(*[map(mul, u, v) for u, v in terms]))]

    a, b, c, d, e, f = (factors[k::6] for k in range(6))
    six = [plus((a, a)), plus((a, b)), plus((a, d))]  # W by rows from the diagonal on
    six += [plus((b, b), (c, c)), plus((b, d), (c, e)), plus((d, d), (e, e), (f, f))]
    places, u, H = ((0, 1, 2), (1, 3, 4), (2, 4, 5)), [one, x[::3], x[1::3], x[2::3]], Matrix()
    forces = [plus(*[(six[k], y[j::3]) for j, k in enumerate(row)]) for row in places]  # W y
    for i, left in enumerate(u):
        products = [[*map(mul, left, right)] for right in u[i:]]
        sums = [[sum(map(mul, w, p)) for w in six] for p in products]
        for k, row in enumerate(places):
            entries = [part[place] for part in sums for place in row]
            H.append([*entries[k:], -sum(map(mul, forces[k], left))])
    return [*H, [sum(sum(map(mul, force, y[k::3])) for k, force in enumerate(forces))]]


@dataclass(frozen=True, repr=False)
class CheckedSprings:
    """The objective: at R(q) it is unit F(q)/|q|^4."""

    F: list[int]  # in the order of QUARTICS
    unit: Fraction
    free: int  # how many independent shifts cost nothing
    weight: Fraction
    lever: Fraction  # sum tr W |x - mean|^2, with the mean by tr W

    @classmethod
    def of(cls, H: Matrix, e: int, *, moves: bool = True) -> CheckedSprings:
        """Of `spring_moments`: the three entries of t are eliminated, one after the other.

        With t = 0, where it does not move, they are left out, and the mean of x is taken for 0.
        Bareiss: all divisions are exact, by the last pivot. Where a pivot is 0 all beside it is, as
        H is positive semidefinite.
        """
        weight, last, free, rows = sum([row[0] for row in H[:3]]), 1, 0, H
        require(weight > 0, "all springs are 0")
        means = [sum([row[3 * j + 3] for row in H[: 3 * moves]]) for j in range(3)]  # times weight
        lever = sum([row[0] for row in H[3:12]]) - Fraction(sum([k * k for k in means]), weight)
        for _ in H[: 3 * moves]:
            (p, *h), *rows = rows
            of, free = enumerate(rows), free + (p == 0)
            if p:
                rows = [[(p * a - h[i] * b) // last for a, b in zip(r, h[i:])] for i, r in of]
                last = p
        form = [*chain(*rows[-10:])]
        F = [sum([k * form[at] for at, k in terms.items()]) for terms in _quartic_terms().values()]
        return cls(F, _dyadic(1, e) / last, free, weight * _dyadic(1, e) / 3, lever * _dyadic(1, e))

    def at(self, q: Sequence[int]) -> Fraction:
        """The objective at R(q)."""
        value = sum([c * q[i] * q[j] * q[k] * q[m] for c, (i, j, k, m) in zip(self.F, QUARTICS)])
        return self.unit * Fraction(value, sum(c * c for c in q) ** 2)


@cache
def _quartic_terms() -> dict[Monomial, dict[int, int]]:
    """Of each of QUARTICS: which entries of a 10x10 form in ROTATION, from each diagonal on."""
    r = [[(int(t[k] + "1"), t[k + 1 : k + 3]) for k in (0, 3, 6, 9)] for t in ROTATION.split()]
    terms: dict[Monomial, dict[int, int]] = {monomial: {} for monomial in QUARTICS}
    for at, (left, right) in enumerate(combinations_with_replacement(r, 2)):
        for (s, a), (t, b) in ((one, other) for one in left for other in right):
            found = terms[tuple(map(int, sorted(a + b)))]
            found[at] = found.get(at, 0) + s * t * (1 + (left is not right))
    return terms


SPRUNG_PAIRS = (
    6,
    spring_moments,
    (
        "springs are others, or not given: as for certify give --springs KIND, --normals FILE or "
        "the like, and --sigma or --weights"
    ),
)
SUMS.update(dict.fromkeys(SpringsStatement.prefixes, SPRUNG_PAIRS))
# --- end of part: springs -----------------------------------------------------------------------
# --- part: growth -------------------------------------------------------------------------------
# What follows of an optimum of general springs from how the objective grows around it.


def settled(
    stated: SpringsStatement, f: CheckedSprings, *bounds: Fraction, tied: bool = False
) -> Outcome:
    """What follows where every rotation S, at an angle a from R, satisfies (+).

        f(S) > f(R) - delta + mu sin^2(a/2),                                                   (+)

    mu >= 0, and max f - min f <= width; RefusalError if a claim does not follow.
    Gap: f(R) - min f < delta. Angle: at an optimum f(S) <= f(R), so sin^2(a/2) < delta/mu.
    Unique if 4 width delta <= mu^2, 2 mu <= width. Were there two, let q(s) run on the circle of
    their quaternions, s the angle from the middle, the two at s = -+ b, 0 < b <= pi/2. There
    f - min f, of degree four in cos(s/2), sin(s/2), is >= 0 and 0 at both: c (cos b - cos s)^2, and
    c (1 + cos b)^2 <= width. If q(v) is next to R, sin^2(a/2) >= sin^2((s - v)/2), which at s or -s
    is at least (1 - cos s)/2, 0 <= s <= pi/2: so c (cos b - cos s)^2 > mu (1 - cos s)/2 - delta. At
    s = b: 1 - cos b < 2 delta/mu <= mu/(2 width) <= 1/4. With h = mu (1 + cos b)^2/(4 width) <= 1/2
    at cos s = cos b - h: width h^2/(1 + cos b)^2 > mu (1 - cos b + h)/2 - delta. So delta >
    mu (1 - cos b)/2 + mu^2 (1 + cos b)^2/(16 width) >= mu^2/(4 width): no two.
    """
    delta, mu, width = bounds
    value, sin2, unique = f.at(stated.pose), stated.sin2_half_angle, stated.unique
    require(stated.gap >= delta, "claims.gap is not proved")
    require(sin2 is None or 0 < delta <= sin2 * mu, "claims.sin2_half_angle is not proved")
    one = 0 < 4 * max(width, 2 * mu) * delta <= mu**2
    several = tied or (stated.symmetry is not None and is_symmetry(f.F, stated.symmetry))
    require(unique is None or (one if unique else several), "claims.unique is not proved")
    weigh, steady = partial(_worth, f, value, delta, mu), (mu, delta, value, 3 * f.weight, f.lever)
    words = tuple(_words(stated, f, weigh(), stated.steady_by_growth(*steady)))
    return Outcome(verified=True, weigh=weigh, tell=partial(tuple, words))


def is_symmetry(F: Sequence[int], turns: Sequence[int]) -> bool:
    """Whether F is constant along the flow q' = a q + q b, which moves every rotation.

    For if |a|, |b| differ, a and b pure quaternions, q' is orthogonal to q and not 0.
    """
    a, b, c, d, e, f = turns
    rows = [[0, -a - d, -b - e, -c - f], [a + d, 0, f - c, b - e]]
    rows += [[b + e, c - f, 0, d - a], [c + f, e - b, a - d, 0]]
    slope = dict.fromkeys(QUARTICS, 0)
    for (k, m), at, j in product(zip(F, QUARTICS), range(4), range(4)):  # q_i: (a q + q b)_i
        slope[tuple(sorted((*m[:at], j, *m[at + 1 :])))] += k * rows[m[at]][j]
    return a * a + b * b + c * c != d * d + e * e + f * f and not any(slope.values())


def _worth(springs: CheckedSprings, value: Fraction, delta: Fraction, mu: Fraction) -> Worth:
    """The range of f is no less than how far f(R) is from its mean over all rotations.

    The mean of q_i^4 is 3/24, of q_i^2 q_j^2 1/24. F = k |q|^4 is constant. Angle: a/2 < tan(a/2) <
    sqrt(s/(1 - s)) where sin^2(a/2) < s = delta/mu < 1; the bound is below pi if s < 0.7.
    """
    F, s = springs.F, delta / mu if mu else Fraction(1)
    away = abs(springs.unit * sum([c * (5 - 2 * k) for k, c in zip(SQUARE, F) if k]) / 24 - value)
    share = delta / away if away else Fraction([k * F[0] for k in SQUARE] != F)
    angle = root_up(*(4 * s / (1 - s)).as_integer_ratio()) if s < Fraction(7, 10) else None
    length, least = root_up(*(delta / springs.weight).as_integer_ratio()), max(value - delta, 0)
    return Worth(springs.weight, value, Fraction(least), delta, length, share, angle)


def _words(
    stated: SpringsStatement, springs: CheckedSprings, w: Worth, steady: list[str]
) -> Iterator[str]:
    yield f"Data: n = {stated.n} pair{'s'[stated.n < 2 :]}, each with a matrix W of springs."
    yield f"SHA-256 of their doubles is {stated.digest}."
    length = isqrt(sum(c * c for c in stated.pose) << 128)
    unit = ", ".join(f"{(c << 64) / length:.12f}" for c in stated.pose)
    yield f"The certified rotation R is that of the quaternion ({unit}), rounded here; w first."
    mass, value = (f"{rounded(x, 12):g}" for x in (w.weight, w.objective))
    shift = "no translation" if stated.rotation_only else "best translation"
    yield f"Sum of tr W / 3: {mass}; objective at R, {shift}: {value}; both rounded up."
    if not stated.rotation_only:
        yield f"Independent directions of shifts that cost nothing: {springs.free}."
    gap, share = (f"{rounded(x, 2):.1e}" for x in (w.gap, w.share))
    yield f"The objective at R exceeds the global minimum by less than {gap} (sum of r^T W r)."
    yield f"So the minimum is at least {rounded(w.minimum, 12, ROUND_FLOOR):g}."
    part = f"is less than {share} of" if w.share < 1 else "bounds nothing: not proved to be below"
    all_ = "The range of energies is 0: every rotation is optimal."
    yield f"This gap {part} the range of energies, over all rotations." if w.share else all_
    if w.angle is not None:
        yield f"Every global optimum is within {rounded(w.angle * DEGREES, 2):.1e} degrees of R."
    elif w.share:
        yield "No angle is bounded: nothing is proved of how far R is from an optimum."
    told = "NOT unique: other rotations have the same objective"
    told = "unique: every other rotation has a larger objective" if stated.unique else told
    told = told if stated.unique is not None else "unique or not: that is undecided"
    yield f"The rotation of the global optimum is {told}."
    yield from steady
    yield "Not proved: anything under `about`, and where the points come from."


# --- end of part: growth ------------------------------------------------------------------------
# --- kind: springs-sos --------------------------------------------------------------------------
# Claims: the pose is optimal up to proved bounds, by a sum of squares of degree four.

Gram = tuple[int, ...]
LENGTHS.update(Gram=(21,))
TIMES = [24 // prod([factorial(m.count(i)) for i in range(4)]) for m in QUARTICS]  # in (u.p)^4
ERROR = 2 * len(QUARTICS)  # of each coefficient two parts are rounded


@dataclass(frozen=True)
class SpringsSosStatement(SpringsStatement):
    """level, mu and gram make the proof, integers over 2^unit; the rest is claimed."""

    kind: ClassVar = "springs-sos"
    keys: ClassVar = {**SPRINGS_KEYS, "proof": "gram level mu pose symmetry unit"}

    level: int
    mu: int
    unit: int
    gram: Gram  # twenty integers, and k: they are times 2^k

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """All claims: f(R(p)) > 2^unit (level - ERROR + mu (1 - (u.p)^2)) for unit quaternions p.

        Here u is the pose over its length. For the coefficients of f/2^unit - level |p|^4 -
        mu (|p|^4 - (u.p)^4) exceed those of a sum of squares s^T G s/2, G > 0, s the ten
        PRODUCTS of p, by less than 2 each, |p_i p_j p_k p_l| <= 1, and (u.p)^4 <= (u.p)^2.
        """
        del equal
        springs, norm, (*gram, k) = (
            self.springs(m, e),
            sum(c * c for c in self.pose),
            self.gram,
        )
        good = norm > 0 and self.mu >= 0 <= k <= BITS and abs(self.unit) <= EXPONENT_MAX
        require(good, "mu >= 0, a pose other than 0 and small exponents needed")
        unit, level, mu = _dyadic(1, self.unit), self.level, self.mu
        over = springs.unit / unit
        F = [c * over.numerator // over.denominator for c in springs.F]
        largest = max(map(abs, (*F, *gram, level, mu)))
        require(largest >> BITS == 0, "a number of the proof has too many bits")
        q, at = [self.pose[i] * self.pose[j] for i, j in PRODUCTS], PRODUCTS.index
        pairs = [(q[at(m[:2])], q[at(m[2:])]) for m in QUARTICS]
        along = [k * i * j * mu // norm**2 for k, (i, j) in zip(TIMES, pairs)]
        G = gram_matrix([*map(add, F, along)], [c << k for c in gram])
        for row, (i, j) in zip(G, PRODUCTS):
            row[0] -= 2 * (level + mu) * (1 + (i < j))  # of (level + mu) |p|^4
        require(positive_definite(G), "level, mu and gram do not prove the pose optimal")
        delta = springs.at(self.pose) - (level - ERROR) * unit
        width = sum([abs(c - level * k) for c, k in zip(F, SQUARE)]) + 2 * ERROR
        return settled(self, springs, delta, mu * unit, width * unit)


def gram_matrix(P: list[int], free: Sequence[int]) -> Matrix:
    """Rows from the diagonal on of G with s^T G s = 2 P, s the ten PRODUCTS of a quaternion.

    Of the products of two PRODUCTS that are the same monomial all but the first have the
    coefficients in `free`, in the order of rows; the first has what is left.
    """
    left, rest, first = dict(zip(QUARTICS, P)), iter(free), dict[Monomial, tuple[int, int]]()
    G = [[0] * k for k in range(10, 0, -1)]
    for i, a in enumerate(PRODUCTS):
        for j, b in enumerate(PRODUCTS[i:]):
            monomial = tuple(sorted(a + b))
            if first.setdefault(monomial, (i, j)) != (i, j):
                G[i][j] = next(rest)
                left[monomial] -= G[i][j]
    for monomial, (i, j) in first.items():
        G[i][j] = left[monomial]
    return [[2 * row[0], *row[1:]] for row in G]


# --- end of kind: springs-sos -------------------------------------------------------------------
# --- kind: springs-cones ------------------------------------------------------------------------
# Claims: the pose is optimal up to proved bounds, by cutting the quaternions into cones.

CAPS_MAX, CONES_MAX, CUTS_MAX = 12, 300_000, 256  # CUTS_MAX: of an orthant down to a cone
CONE_BITS = 124  # of Bernstein coefficients: the bend of three fits in 128
POWERS = [prod([factorial(m.count(i)) for i in range(4)]) for m in QUARTICS]  # 24/multinomials
Caps = tuple[int, ...]  # of each: the centre, a quaternion; mantissa and exponent of its curvature
LENGTHS.update(Caps=range(0, 6 * CAPS_MAX + 1, 6))
Cap = tuple[Sequence[int], int]  # its centre c; it holds v where (c.v)^2 2^BITS >= level |v|^2
Cone = tuple[Sequence[int], Sequence[Sequence[int]], int]  # coefficients, vertices, cuts
Half = Callable[[Sequence[int]], Sequence[int]]
Edge = tuple[tuple[int, int], list[tuple[int, int]], tuple[Half, Half]]  # as `cutting` says


@dataclass(frozen=True)
class SpringsConesStatement(SpringsStatement):
    """mu and caps make the proof, which the checker finds again by itself; the rest is claimed."""

    kind: ClassVar = "springs-cones"
    keys: ClassVar = {**SPRINGS_KEYS, "proof": "caps mu pose symmetry"}

    mu: Fraction
    caps: Caps

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """(+) with delta = claims.gap, in caps by their curvature and outside of them by cones.

        Where a tie is claimed, delta = 0 is proved, by `>` outside of the caps: all optima lie in
        them, and if the pose and another centre are stationary, with one value, both are optima.
        """
        del equal
        springs, norm = self.springs(m, e), sum(c * c for c in self.pose)
        tie = self.unique is False and self.symmetry is None
        good = norm > 0 and self.gap > 0 and (self.mu == 0 if tie else self.mu >= 0)
        require(good, "a pose, gap > 0 and mu >= 0 needed, mu = 0 for a tie")
        delta = Fraction(0) if tie else self.gap
        width, value, caps, tied = spread(springs), springs.at(self.pose), list[Cap](), False
        for at in range(0, len(self.caps), 6):
            *centre, number, exponent = self.caps[at : at + 6]
            curvature = _dyadic(number, exponent)
            good = any(centre) and max(map(abs, centre)) >> BITS == 0 < curvature
            require(good, "a cap has no centre, one of too many bits, or no curvature")
            slope, other = local(springs, centre, curvature), springs.at(centre)
            here = sum(c * c for c in centre) * norm == sum(map(mul, centre, self.pose)) ** 2
            depth = delta if here else other - value + delta - self.mu
            room = (curvature - self.mu * here) * depth
            require(slope < room or (tie and slope == depth == 0), "a cap proves too little")
            tied = tied or (tie and not here and other == value)
            caps.append(cap_of(centre, curvature / width))
        level, growth = (value - delta) / springs.unit, self.mu / springs.unit
        form = growth_form(springs.F, self.pose, level, growth)
        prove_positive(form, caps)
        return settled(self, springs, self.gap, self.mu, width, tied=tied)


def spread(springs: CheckedSprings) -> Fraction:
    """At least max f - min f: f is unit (c + sum of (F_m - c k_m) q^m), |q| = 1, k those of |q|^4.

    For any c, here the mean of f. The powers a, b, ... of q^m add up to 4, and its square is at
    most a^a b^b .../4^4: |q^m| is at most min(16, a! b! ...)/16. It is >= 0 if k_m is.
    """
    mean = sum([c * (5 - 2 * k) for k, c in zip(SQUARE, springs.F) if k])  # 24 times
    parts = [(abs(24 * c - k * mean), k, t) for c, k, t in zip(springs.F, SQUARE, POWERS)]
    total = sum([size * (2 - (k > 0)) * min(16, times) for size, k, times in parts])
    return springs.unit * Fraction(total, 24 * 16)


def local(springs: CheckedSprings, c: Sequence[int], curvature: Fraction) -> Fraction:
    """The square of the slope of f at R(c), where the Hessian there is > curvature I; by angles.

    Along exp(s [d]) R(c), |d| = 1, the quaternion is u + s/2 e - s^2/8 u + ..., u = c/|c|, e = d u
    the combination of iu, ju, ku with the coefficients d. So the derivatives of f are unit times
    F'(u) e/2 and (e^T F''(u) e - 4 F(u))/4, as F'(u) u = 4 F(u).
    """
    (w, x, y, z), norm = c, sum(k * k for k in c)
    second = [[0] * 4 for _ in c]
    for (k, m), i, j in product(zip(springs.F, QUARTICS), range(4), range(4)):
        rest = [c[m[a]] for a in range(4) if a not in (i, j)]
        second[m[i]][m[j]] += k * (i != j) * prod(rest)
    frame = [-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]
    images = [[sum(map(mul, row, e)) for row in second] for e in frame]
    p, q = (4 * norm**2 * (springs.at(c) + curvature) / springs.unit).as_integer_ratio()
    A = [[q * sum(map(mul, b, e)) - p * (b is d) for d, e in zip(images, frame)] for b in images]
    require(definite(A), "a cap's curvature is not proved")
    square = sum([sum(map(mul, image, c)) ** 2 for image in images])  # (3 F' e)^2
    return springs.unit**2 * Fraction(square, 36 * norm**4)


def cap_of(c: Sequence[int], ratio: Fraction) -> Cap:
    """The rotations within r = ratio/8 of R(c); ratio is a curvature there over max f - min f.

    Along exp(s d) R, |d| = 1, f is a trigonometric polynomial of degree 2 in s. By Bernstein's
    inequality, for f less the middle of its range, its second derivative is at most 2 (max f -
    min f) in size. That is a polynomial of degree 2 on the rotations, too, for every d, and again
    by Bernstein its slope is at most 4 (max f - min f). So the Hessian within r exceeds half the
    curvature k, k <= 2 (max f - min f), r <= 1/4: a ball that holds the geodesics between its
    points. There f >= f(R(c)) - slope a + k a^2/4, a the angle to R(c): at least
    f(R(c)) - slope^2/k, and above f(R(c)) - delta + mu sin^2(a/2) if slope^2 < (k - mu) delta.
    R(q) is within r if (c.q)^2 >= cos^2(r/2) |c|^2 |q|^2, and cos^2 x <= 1 - x^2 (1 - x^2/3).
    """
    x = ratio / 16
    least = (1 - x**2 * (1 - x**2 / 3)) * sum(k * k for k in c) * 2**BITS
    return c, -(-least.numerator // least.denominator)


def holds(cap: Cap, vertices: Sequence[Sequence[int]]) -> bool:
    """Whether the cone of these vertices lies in the cap, or in its mirror image: all of them do.

    Either is convex, {q: c.q >= k |q|} with k > 0; q and -q are the same rotation.
    """
    c, least = cap
    along = [sum(map(mul, c, v)) for v in vertices[:1]]
    if any(a * a << BITS < least * sum(map(mul, v, v)) for a, v in zip(along, vertices)):
        return False
    along += [sum(map(mul, c, v)) for v in vertices[1:]]
    good = all(a * a << BITS >= least * sum(map(mul, v, v)) for a, v in zip(along, vertices))
    return good and (min(along) > 0 or max(along) < 0)


def growth_form(F: Sequence[int], u: Sequence[int], level: Fraction, mu: Fraction) -> list[int]:
    """Coefficients of F - level |q|^4 - mu |q|^2 (|q|^2 - (u.q)^2/|u|^2), over some number > 0."""
    norm = sum(k * k for k in u)
    along = mu / norm
    one = level.denominator * along.denominator
    P = {m: k * one for m, k in zip(QUARTICS, F)}
    for i, j, k in product(range(4), repeat=3):
        entry = (level + mu) * (i == j) - along * u[i] * u[j]
        P[tuple(sorted((i, j, k, k)))] -= int(entry * one)
    return [*P.values()]


def prove_positive(P: Sequence[int], caps: Sequence[Cap]) -> None:
    """RefusalError unless the form P is > 0 at all q != 0 but in the caps, as it is seen by cones.

    Each line through 0 meets one of the cones of e_0, +-e_1, +-e_2, +-e_3. On that of v_0 ... v_3,
    P(q) = sum of b_m (24/POWERS_m) s^m, q = s_0 v_0 + ..., s >= 0: if all b_m > 0 then P > 0. Else
    it is cut in two at v_i + v_j; b_m are then means of two, and so on (de Casteljau). Rounded down
    they stay below the true ones, as each mean increases with both. Cuts go where the b_m along an
    edge bend most, but every eighth round the edges, after six of which a cone is narrower.
    """
    shared = gcd(*P) or 1
    entries = [k // shared * times for k, times in zip(P, POWERS)]
    low = max([abs(k) for k in entries]).bit_length() - CONE_BITS
    up, low, (edges, bent), cones = max(-low, 0), max(low, 0), cutting(), list[Cone]()
    for signs in product((1,), (1, -1), (1, -1), (1, -1)):
        b = [(k << up) * prod([signs[i] for i in m]) >> low for k, m in zip(entries, QUARTICS)]
        vertices = [[s * (i == j) << CUTS_MAX for j in range(4)] for i, s in enumerate(signs)]
        cones.append((b, vertices, 0))
    for _ in range(CONES_MAX):
        if not cones:
            return
        b, vertices, cuts = cones.pop()
        if min(b) > 0 or any(holds(cap, vertices) for cap in caps):
            continue
        values = [k for k, m in zip(b, QUARTICS) if m[0] == m[3]]
        bare = [v for v, value in zip(vertices, values) if value <= 0]
        good = all(any(holds(cap, [v]) for cap in caps) for v in bare)
        require(good, "at a rotation outside of the caps the objective is too small")
        require(cuts < CUTS_MAX, "the gap is too small for these cones")
        bends = [abs(b[x] - 2 * b[y] + b[z]) for x, y, z in bent]
        turn = cuts // 8 % 6 if cuts % 8 == 7 else bends.index(max(bends)) // 3
        (i, j), sums, halves = edges[turn]
        middle = [(x + y) // 2 for x, y in zip(vertices[i], vertices[j])]
        means = [*b]
        for x, y in sums:
            means.append(means[x] + means[y] >> 1)
        for half, out in zip(halves, (j, i)):
            corners = [*vertices[:out], middle, *vertices[out + 1 :]]
            cones.append((half(means), corners, cuts + 1))
    require(not cones, f"more than {CONES_MAX} cones are needed")


@cache
def cutting() -> tuple[list[Edge], list[tuple[int, ...]]]:
    """Of each edge v_i, v_j: which means come next, and which are the halves' coefficients.

    A half keeps v_i, or v_j. And of each three in turn that bend: of s_i^4, s_i^3 s_j, ..., s_j^4.
    """
    edges, bent = list[Edge](), list[tuple[int, ...]]()
    for i, j in [(i, j) for i, j in PRODUCTS if i < j]:
        left, right, sums, row = [0] * 35, [0] * 35, list[tuple[int, int]](), list[int]()
        for degree in range(5):
            for others in combinations_with_replacement({*range(4)} - {i, j}, 4 - degree):
                powers = [(i,) * (degree - k) + (j,) * k for k in range(degree + 1)]
                row = now = [QUARTICS.index(tuple(sorted(others + some))) for some in powers]
                for k in range(degree + 1):
                    left[row[k]], right[row[degree - k]], here = now[0], now[-1], 35 + len(sums)
                    sums += [(now[at], now[at + 1]) for at in range(degree - k)]
                    now = [*range(here, here + degree - k)]
        edges.append(((i, j), sums, (itemgetter(*left), itemgetter(*right))))
        bent += zip(row, row[1:], row[2:])
    return edges, bent


# --- end of kind: springs-cones -----------------------------------------------------------------
# --- kind: springs-list -------------------------------------------------------------------------
# Claims: all rotations at equilibrium, the index of each, and the optimum among them.

ENTRY_MAX, MODULI_MAX = 2**16, 2**62  # of the chart; bounds the time
CUBICS: list[Monomial] = [*combinations_with_replacement(range(4), 3)]
CYCLE = (1, 2), (2, 0), (0, 1)
Indices = Lines = tuple[int, ...]
LENGTHS.update(Indices=range(41), Lines=range(120, 241, 6))
Form = dict[Monomial, int]  # coefficients
Line = list[tuple[int, int]]  # P = (2^bits, x, y, z), x, x' of x + ix'; its box: |p_i - P_i| <= 1


@dataclass(frozen=True)
class SpringsListStatement(SpringsStatement):
    """indices: of all equilibria, R's first. second: the objective at the others is at least that.

    lines: x, x', y, y', z, z' of each that is real and of one of two that are conjugate.
    """

    kind: ClassVar = "springs-list"
    keys: ClassVar = {
        "": "about claims format kind problem proof rotation_only?",
        "claims": "gap indices second sin2_half_angle unique",
        "problem": "data digest n",
        "proof": "bits chart lines modulus pose",
    }

    bits: int
    chart: tuple[int, int, int, int]
    indices: Indices
    lines: Lines
    modulus: int
    second: Fraction

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """R(a p), a the chart, is at equilibrium where G'(p) = l p, p real, G as in `in_chart`.

        There are at most 40 complex lines of such p != 0 (`are_forty`): 40 boxes that are apart and
        hold one each (`slopes_at`) hold all. Where P is real so is the line, as its box is its own
        mirror image; the other boxes are apart from theirs, and hold none that is real.
        """
        del equal
        springs, numbers, (w, x, y, z) = self.springs(m, e), self.lines, self.chart
        good = 0 < max(map(abs, self.chart)) <= ENTRY_MAX and 0 <= self.bits <= BITS
        good = good and 1 < self.modulus < MODULI_MAX and max(map(abs, numbers)) >> 2 * BITS == 0
        require(good, "bits, chart, lines or modulus are out of range")
        rows = [numbers[k : k + 6] for k in range(0, len(numbers), 6)]
        lines = [[(1 << self.bits, 0), *zip(row[::2], row[1::2])] for row in rows]
        real = [P for P in lines if not any(map(itemgetter(1), P))]
        boxes = lines + [[(x, -y) for x, y in P] for P in lines if P not in real]
        pairs = [[*zip(P, Q)] for k, P in enumerate(boxes) for Q in boxes[:k]]
        far = [max([(a - c) ** 2 + (b - d) ** 2 for (a, b), (c, d) in pair]) for pair in pairs]
        require(len(boxes) == 40 and min(far) > 4, "the boxes are not 40 that are apart")
        left = [[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]  # a p = left p
        minors = minors_of(G := in_chart(springs.F, left))
        require(are_forty(minors, self.modulus), "chart and modulus do not prove that 40 are all")
        most = max([sum(map(abs, E.values())) for E in minors])
        tables = [derivatives(E) for E in minors[:3]]
        slopes = [slopes_at(P, tables, most) for P in lines]
        indices = [index_of(P, J, most) for P, J in zip(lines, slopes) if P in real]
        require([*self.indices] == indices, "claims.indices is not proved")
        q = [[sum([a * x for a, (x, _) in zip(row, P)]) for row in left] for P in real]
        return self._settled(springs, q, springs.unit * sum(map(abs, G.values())) / 12)

    def _settled(self, f: CheckedSprings, q: Matrix, width: Fraction) -> Outcome:
        """Let q = a P, P real, p in the box of P; s the angle between q and a p.

        sin^2 s < 3 |a|^2/|q|^2, and R(q) is 2 s <= pi sin s from R(a p). Along a geodesic f is a
        trigonometric polynomial of degree 2: |f''| <= 2 (max f - min f) (Bernstein), and f' = 0 at
        p: |f(R(q)) - f(R(a p))| is below (max f - min f) 30 |a|^2/|q|^2. One f(R(a p)) is the
        minimum. And max f - min f <= width/|a|^4, as |G(p)| <= the sum of |its coefficients|.
        """
        u, norm = self.pose, sum(k * k for k in self.chart)
        parallel = all(u[i] * q[0][j] == u[j] * q[0][i] for i, j in PRODUCTS)
        require(any(u) and parallel, "the pose is not that of the first real line")
        sines, values = [Fraction(3 * norm, sum(k * k for k in p)) for p in q], [*map(f.at, q)]
        floors = [value - 10 * width * sine / norm**2 for value, sine in zip(values, sines)]
        gap, second, angle = values[0] - min(floors), min(floors[1:]), self.sin2_half_angle
        one = 2 * values[0] - floors[0] < second
        require(self.gap >= gap, "claims.gap is not proved")
        require(self.second <= second, "claims.second is not proved")
        known = angle is None or (one and angle >= sines[0])
        require(known, "claims.sin2_half_angle is not proved")
        require(self.unique is None or (self.unique and one), "claims.unique is not proved")
        weigh = partial(_worth, f, values[0], gap, gap / sines[0] if one else Fraction(0))
        words = tuple(_words(self, f, weigh(), self._told(values[0])))
        return Outcome(verified=True, weigh=weigh, tell=partial(tuple, words))

    def _told(self, value: Fraction) -> list[str]:
        """All equilibria in words; value: the objective at R."""
        stable, *ways = [self.indices.count(k) for k in range(4)]
        real, room = len(self.indices), self.second - value
        floor = max(self.second, Fraction(0))  # the objective is a sum of squares
        least, above = (f"{rounded(x, 12, ROUND_FLOOR):g}" for x in (floor, room))
        told = f"more than {above} above R's" if room > 0 else "not proved to be above R's"
        return [
            f"Rotations at equilibrium: {real}, no others. All 40 complex solutions are simple.",
            f"Stable: {stable}. Unstable, with 1, 2, 3 ways down: {', '.join(map(str, ways))}.",
            f"At all equilibria but that of R the objective is at least {least}: {told}.",
        ]


def in_chart(F: Sequence[int], left: Matrix) -> Form:
    """G(p) = 24 F(a p) - mean |a p|^4, mean that of 24 F: what was critical still is."""
    mean = sum([k * (5 - 2 * times) for times, k in zip(SQUARE, F) if times])
    form = {m: 24 * k - mean * times for m, times, k in zip(QUARTICS, SQUARE, F)}
    for at in range(4):  # factor by factor
        old, form = form, Form()
        for (m, k), j in product(old.items(), range(4)):
            new = (*m[:at], j, *m[at + 1 :])
            form[new] = form.get(new, 0) + k * left[m[at]][j]
    return form


def minors_of(G: Form) -> list[Form]:
    """p_i G_j - p_j G_i, i < j, G_j the derivatives."""
    minors = list[Form]()
    for i, j in [(i, j) for i, j in PRODUCTS if i < j]:
        minors.append(dict.fromkeys(QUARTICS, 0))
        for (m, c), at in product(G.items(), range(4)):
            if m[at] in (i, j):
                new = tuple(sorted((*m[:at], i + j - m[at], *m[at + 1 :])))
                minors[-1][new] += c if m[at] == j else -c
    return minors


def are_forty(minors: Sequence[Form], modulus: int) -> bool:
    """Whether the minors vanish on 40 lines at most, multiplicities counted in, all with p_0 != 0.

    Let A_d be the forms of degree d modulo the minors, of degree four. If, for p_0 = 0, products of
    these and the 15 monomials of degree four in p_1, p_2, p_3 span all 45 dimensions of degree
    eight, no line has p_0 = 0, and A_d = p_0 A_(d-1), d >= 8. If those with all 20 of degree three
    span 80 of 120, A_7 has 40 at most, and so have all later A_d and, for p_0 = 1, the polynomials
    modulo the minors: there are no more points.
    """
    for first, rank in (1, 45), (0, 80):
        factors = [*combinations_with_replacement(range(first, 4), 3 + first)]
        all_ = [*combinations_with_replacement(range(first, 4), 7 + first)]
        rows = [{tuple(sorted(m + k)): E[m] for m in E} for E in minors for k in factors]
        if not has_rank([[row.get(m, 0) for m in all_] for row in rows], rank, modulus):
            return False
    return True


def inner(u: Line, v: Line) -> tuple[int, int]:
    """The sum of products."""
    (a, b), (c, d) = zip(*u), zip(*v)
    return sum(map(mul, a, c)) - sum(map(mul, b, d)), sum(map(mul, a, d)) + sum(map(mul, b, c))


def derivatives(E: Form) -> list[Line]:
    """Coefficients of the four, in the order of CUBICS."""
    return [[(E[tuple(sorted((*k, j)))] * (k.count(j) + 1), 0) for k in CUBICS] for j in range(4)]


def slopes_at(P: Line, tables: list[list[Line]], most: int) -> list[Line]:
    """J, the derivatives at P of E, the first three minors; of which the box holds one simple zero.

    The other minors vanish there, too: p_0 (p_i G_j - p_j G_i) = p_i E_j - p_j E_i. With Y = J^-1,
    if in each row |Y E| + b sum |Y| < 1, b a bound on how the sum of |J_ij| in a row changes in the
    box, p -> p - Y E(p) takes it into itself and is a contraction (Banach). Where |p_i| <= s all
    second derivatives of E_i add up to 12 s^2 most, most the sum of its |coefficients|.
    """
    cubes = [inner([inner([P[i]], [P[j]])], [P[k]]) for i, j, k in CUBICS]
    rows, s = [[inner(d, cubes) for d in row] for row in tables], [abs(x) + abs(y) for x, y in P]
    E, J = [inner(row, P) for row in rows], [row[1:] for row in rows]  # E four times
    N = [[(-x, -y) for x, y in row] for row in J]
    Y = [[inner([J[i][c], J[i][d]], [J[j][d], N[j][c]]) for i, j in CYCLE] for c, d in CYCLE]
    x, y = inner(J[0], [row[0] for row in Y])  # det J, and so often is Y
    for row in Y:
        (u, v), size = inner(row, E), sum([abs(k) for entry in row for k in entry])
        room = 4 * (isqrt(x * x + y * y) - 12 * (max(s) + 1) ** 2 * most * size)
        require(room > 0 and u * u + v * v < room**2, "a box is not seen to hold one line")
    return J


def index_of(P: Line, J: list[Line], most: int) -> int:
    """How many eigenvalues of the Hessian of f are negative at the line in the box of P, real.

    In p_1, p_2, p_3 f' is a number > 0 times B E, B = |p|^2 I - v v^T, v = (p_1, p_2, p_3). So the
    Hessian is that times B J where E = 0. Entries of B J, of degree five, are at most 28 s^5 most
    where |p_i| <= s: in the box they change by 140 s^4 most, and eigenvalues by thrice as much.
    Changes of sign in det(t I + A) count the negative ones of A, as all are real (Descartes).
    """
    (_, *v), norm, three = [x for x, _ in P], sum([x * x for x, _ in P]), range(3)
    along = [sum([x * row[j][0] for x, row in zip(v, J)]) for j in three]
    D = [[norm * J[i][j][0] - v[i] * along[j] for j in three] for i in three]
    change, found = 420 * (max([abs(x) for x, _ in P]) + 1) ** 4 * most, set[int]()
    for by in (-change, change):
        A = [[D[i][j] + D[j][i] + 2 * by * (i == j) for j in three] for i in three]
        (a, b, c), (_, d, e), (_, _, f) = A
        minors = a * d - b * b + a * f - c * c + d * f - e * e
        last = a * d * f + 2 * b * c * e - a * e * e - d * c * c - f * b * b
        signs = [term > 0 for term in (1, a + d + f, minors, last) if term]
        found.add(sum(map(ne, signs, signs[1:])))
    require(len(found) == 1, "an index is not proved")
    return found.pop()


# --- end of kind: springs-list ------------------------------------------------------------------
# --- part: bounds -------------------------------------------------------------------------------
# For kinds whose pairs have bounds: what these are worth beside the clouds.


def bounds_worth(
    rows: Matrix, bounds: Sequence[int], e: int, *, shifts: bool = True, scales: bool = False
) -> Iterator[str]:
    """The bounds and how far the clouds reach, in words; all numbers are times 2^e.

    From c and d, the middles of the clouds' boxes, or 0 where t = 0. The motion (s, R, d - s R c)
    leaves |y - s R x - t| <= s |x - c| + |y - d|, whatever R. So every pair is within its bound b
    at any rotation if all |x - c| + |y - d| <= b; with a free scale if all |y - d| < b, s small.
    """
    clouds = [[*zip(*[row[k : k + 3] for row in rows])] for k in (0, 3)]
    middles = [[(min(k) + max(k)) * shifts for k in cloud] for cloud in clouds]
    far = [
        [sum([(2 * k - m) ** 2 for k, m in zip(point, middle)]) for point in zip(*cloud)]
        for cloud, middle in zip(clouds, middles)
    ]  # squares of twice the distances
    low, high = (repr(ldexp(end(bounds), e)).removesuffix(".0") for end in (min, max))
    reach = [isqrt(max(squares) << 2 * BITS) * _dyadic(1, e - BITS - 1) for squares in far]
    source, target = (f"{rounded(k, 3, ROUND_FLOOR):g}" for k in reach)
    middle = "the middles of their boxes" if shifts else "the origin"
    yield f"Bounds: least {low}, greatest {high}, as given."
    yield f"The clouds reach at least {source} (source) and {target} (target) from {middle}."
    rooms = [(2 * b) ** 2 - B - (0 if scales else A) for A, B, b in zip(*far, bounds)]
    held = [r > 0 if scales else r >= 0 and r * r >= 4 * A * B for r, A, B in zip(rooms, *far)]
    if all(held):
        small = ", if the scale is small enough" * scales
        yield f"These bounds hold every pair at any rotation{small}: they tell none from another."


# --- end of part: bounds ------------------------------------------------------------------------
# --- kind: truncated-rotation -------------------------------------------------------------------
# Claims: R is optimal up to proved bounds for F(R) = sum min(|y_i - R x_i|^2 / b_i^2, 1), b_i > 0
# the bound of a pair, t = 0; and which pairs are within their bounds at every optimum.

TRUNCATED = b"certreg-truncated-rotation/1\0"
UNITS, CHORD, HALVINGS = 64, 32, 40  # bits of F, of a slope, of an entry of a quaternion
PAIRS_MAX, TESTS_MAX = 10**5, 1 << 24  # of pairs in boxes, 16 more a box: half a minute
Bounded = tuple[list[int], int]


@dataclass(frozen=True)
class TruncatedRotationStatement(Statement):
    """labels: 1, 0, ? of a pair: at every optimum within its bound, not within, no claim."""

    kind: ClassVar = "truncated-rotation"
    prefix: ClassVar = TRUNCATED
    model: ClassVar = "--rotation-only --objective truncated"
    keys: ClassVar = {
        "": "about claims format kind optimality pose problem",
        "claims": "gap labels sin2_half_angle unique",
        "optimality": "mu",
        "problem": "data digest n",
    }

    n: int
    data: str | None
    digest: str
    pose: tuple[int, int, int, int]  # a quaternion of any length; R is its rotation
    gap: Fraction
    labels: str
    mu: Fraction  # makes the proof of the angle short
    sin2_half_angle: Fraction | None
    unique: bool  # only true claims

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """Every rotation S with F(S) <= F(R) has the labels, and F(S) > F(R) - gap (`survey`).

        So have all optima, and R. With u = q/|q|, let c(p) be the sum of |y_i - R(p) x_i|^2 / b_i^2
        over the pairs labelled 1, for unit p. If no label is open, c(p) <= c(u) at an optimum R(p).
        Let L be the sum of the forms of `form_of`: L(p) <= c(p) <= L(p) + 6 n, in their unit. If
        L - (L(u) + 6 n + mu - delta) I + mu u u^T > 0, then c(p) - c(u) > mu (1 - (u.p)^2) - delta
        for all unit p: sin^2(a/2) = 1 - (u.p)^2 < delta/mu, a the angle from R to an optimum. All
        optima minimise c, as F is at most c plus the number of the other pairs. If delta <= mu, c
        has one line of minima: of a plane of them one, p, is across u, and c(p) > c(u).
        """
        del equal  # all is relative to the bounds
        q, norm, known = self.pose, sum(c * c for c in self.pose), {*self.labels}
        require(0 < norm < 1 << 2 * BITS and self.gap > 0, "gap or pose is out of range")
        require(len(self.labels) == self.n and known <= {*"10?"}, "labels are not n of 1, 0, ?")
        pairs, one = [form_of(row) for row in m], 1 << UNITS
        cost = sum([min(-(-form_at(k, q) // norm) + 6, one) for k, _ in pairs])
        gap, angle, mu = self.gap * one, self.sin2_half_angle, int(self.mu * one)
        survey(pairs, self.labels, cost, int(gap))
        delta = 0 if angle is None else int(angle * mu)
        inliers = [k for (k, _), label in zip(pairs, self.labels) if label == "1"]
        L = [*map(sum, zip(*inliers))] or [0] * 10
        level = form_at(L, q) + (6 * self.n + mu - delta) * norm
        A = [[norm * k for k in row] for row in twice(L)]
        for (i, j), k in zip(PRODUCTS, [2 * mu * (q[i] * q[j]) for i, j in PRODUCTS]):
            A[i][j - i] += k - 2 * level * (i == j)
        proved = "?" not in known and mu > 0 and positive_definite(A)
        require(angle is None or proved, "claims.sin2_half_angle is not proved")
        require(not self.unique or (angle and delta <= mu), "claims.unique is not proved")
        wide = max([sum([min(k[j], one) for k, _ in pairs]) for j in (0, 4, 7, 9)]) - cost
        share = Fraction(int(gap) + 1, wide) if wide > 0 else Fraction(1)  # k[j]: F at q = e_i
        least, length = max(cost - gap, Fraction(0)) / one, root_up(int(gap) + 1, self.n * one)
        bound, n = None if angle is None else angle_bound(delta, mu), Fraction(self.n)
        weigh = partial(Worth, n, Fraction(cost, one), least, self.gap, length, share, bound)
        bounds = [*bounds_worth(m, [row[6] for row in m], e, shifts=False)]
        tell, undecided = partial(self._words, weigh(), bounds), self.labels.count("?")
        return Outcome(verified=True, undecided=undecided, weigh=weigh, tell=tell)

    def _words(self, w: Worth, bounds: list[str]) -> Iterator[str]:
        length = isqrt(sum(c * c for c in self.pose) << 128)
        unit = ", ".join(f"{(c << 64) / length:.12f}" for c in self.pose)
        value, least = f"{rounded(w.objective, 12):g}", f"{rounded(w.minimum, 12, ROUND_FLOOR):g}"
        yield f"Data: n = {self.n} pairs, a bound each. SHA-256 of their doubles is {self.digest}."
        yield from bounds
        yield f"The certified rotation R is that of the quaternion ({unit}), rounded here; w first."
        yield "Cost of a rotation: sum of (residual / bound)^2, or of 1 where that is more."
        above = f"less than {rounded(w.gap, 2):.1e} above the global minimum"
        yield f"The cost of R is at most {value}, {above}, which is at least {least}."
        for label, told in ("1", "within"), ("0", "NOT within"):
            rows = [str(k) for k, one in enumerate(self.labels) if one == label]
            more = f" and {len(rows) - 20} more" * (len(rows) > 20)
            named = f": rows {', '.join(rows[:20])}{more} (from 0)" if rows else ""
            yield f"At every global optimum {told} their bounds are {len(rows)} pairs{named}."
        yield f"Pairs of which that is not proved: {self.labels.count('?')}."
        if w.angle:
            degrees = rounded(w.angle * DEGREES, 2)
            yield f"Every global optimum is within {degrees:.1e} degrees of R."
        if self.unique:
            yield "The global optimum is unique: every other rotation has a larger cost."
        yield "Not proved: anything under `about`, and where the points come from."


def bounded_pairs(doubles: bytes | memoryview, n: int) -> tuple[Matrix, int]:
    """Of each pair x, y and its bound, integers times 2^e."""
    require(n <= PAIRS_MAX, f"more than {PAIRS_MAX} pairs")
    weights = struct.unpack_from(f"<{n}d", doubles, 48 * n)
    require({*weights} == {1.0}, "a weight is not 1")
    (*points, bounds), e = _integers(doubles, [*range(0, 6 * n, n), 7 * n], n, EXPONENT_MAX)
    require(min(bounds) > 0, "a bound is not positive")
    x, y = chain(*points[:3]), chain(*points[3:])
    return [[*row] for row in zip(x, x, x, y, y, y, bounds)], e


def form_of(row: Sequence[int]) -> Bounded:
    """A form and a reach of a pair, both in units: 2^UNITS (r/b)^2 and 2^(UNITS/2) r/b.

    With r = |y - R(q) x| the form at q is at most |q|^2 (r/b)^2, and less by 6 |q|^2 at most: ten
    coefficients are rounded down, and sum |q_i q_j| <= 2.5 |q|^2, i <= j. Let |d_j| <= h for three
    entries d_j, the fourth 0. The angle of q + d and q, half of that of their rotations, has a sine
    of |d|/|q| at most: |q| r at R(q + d) and |q| r at R(q) differ by 2 sqrt(3) h min(|x|, |y|), at
    most, and in units by less than h reach.
    """
    x, y, square = row[:3], row[3:6], row[6] ** 2
    K, u, v = davenport([[i * j for j in x] for i in y]), sum(map(mul, x, x)), sum(map(mul, y, y))
    form = [(u + v) * (i == j) - (4 - 2 * (i == j)) * K[i][j] for i, j in PRODUCTS]
    slack = [3 * (i == j) for i, j in PRODUCTS]
    reach = isqrt((12 * min(u, v) << UNITS) // square) + 1
    return [(k << UNITS) // square - s for k, s in zip(form, slack)], reach


def form_at(form: Sequence[int], q: Sequence[int]) -> int:
    """Coefficients in the order of PRODUCTS."""
    return sum([k * q[i] * q[j] for k, (i, j) in zip(form, PRODUCTS)])


def twice(form: Sequence[int]) -> Matrix:
    """Twice its matrix, rows from the diagonal on."""
    a, b, c, d, e, f, g, h, i, j = form
    return [[2 * a, b, c, d], [2 * e, f, g], [2 * h, i], [2 * j]]


def survey(pairs: list[Bounded], labels: str, cost: int, gap: int) -> None:
    """RefusalError where a rotation may be as good as cost, but has not the labels or is too good.

    Every rotation is in one of four boxes: |q_f| is the largest entry of q, q_f = 2^HALVINGS. In a
    box, q_j - h <= p_j <= q_j + h, j != f, each pair is out (its residual r is above b), in (it is
    not), or open; a box of which that is not enough is cut in eight, to which out and in pass.
    Open ones have r <= s, s > b: min(r^2/b^2, 1) >= r^2/s^2, as the left is concave in r^2.
    So F is at least the number of pairs out plus a form, by |p|^2; less the cost it is the form A,
    in units of 2^-(UNITS + CHORD). If A(p) > 0 in all of the box then F > cost there.
    """
    one = 1 << HALVINGS
    units, tests = [[one * (j == f) for j in range(4)] for f in range(4)], 0
    boxes = [(q, f, one, 0, True, [0] * 10, [*range(len(pairs))]) for f, q in enumerate(units)]
    while boxes:
        q, f, h, out, fits, sums, left = boxes.pop()
        tests += len(left) + 16
        require(tests <= TESTS_MAX and h > 1, "the labels or the gap need too many boxes")
        products = [q[i] * q[j] for i, j in PRODUCTS]
        norm, chords, still = sum([c * c for c in q]), [0] * 10, list[int]()
        size = isqrt(norm << UNITS)  # |q| in units
        for k in left:
            form, reach = pairs[k]
            low, far = sum(map(mul, form, products)), reach * h
            if low > (size + 1 + far) ** 2:
                out, fits = out + 1, fits and labels[k] != "1"
                if out << UNITS > cost:
                    break
            elif far <= size and low + 6 * norm <= (size - far) ** 2:
                sums, fits = [*map(add, sums, form)], fits and labels[k] != "0"
            else:
                most = isqrt(low + 6 * norm) + 1 + far  # above size
                slope = (size * size << CHORD) // (most * most)
                chords = [c + slope * a for c, a in zip(chords, form)]
                still.append(k)
        else:
            A = [c + (a << CHORD) for c, a in zip(chords, sums)]
            spare, slack = cost - (out << UNITS), 6 * len(pairs)
            good = positive(A, q, f, h, spare, slack)
            if not good and fits and {labels[k] for k in still} <= {"?"}:
                good = positive(A, q, f, h, spare - gap, slack)
            if not good:
                h //= 2
                for signs in product((-h, h), repeat=3):
                    p = [*map(add, q, (*signs[:f], 0, *signs[f:]))]
                    boxes.append((p, f, h, out, fits, sums, still))


def positive(form: list[int], q: list[int], f: int, h: int, spare: int, slack: int) -> bool:
    """Whether form - spare |p|^2 > 0 in a box; spare and slack by 2^CHORD; form >= -slack |p|^2.

    With p = q + d it is A(q) + the sum of slopes times d_j + A(d), and A(d) >= -(spare + slack)
    |d|^2, |d|^2 <= 3 h^2. Or it is positive everywhere.
    """
    A = [k - (spare << CHORD) * (i == j) for k, (i, j) in zip(form, PRODUCTS)]
    rows, slopes = twice(A), [0, 0, 0, 0]
    for i, j in PRODUCTS:
        slopes[i] += rows[i][j - i] * q[j]
        slopes[j] += rows[i][j - i] * q[i] * (i < j)
    steep = sum(map(abs, slopes)) - abs(slopes[f])
    curved = 3 * h * (max(spare + slack, 0) << CHORD)
    return sum(map(mul, slopes, q)) > 2 * h * (steep + curved) or positive_definite(rows)


SUMS[TRUNCATED] = (2, bounded_pairs, "bounds are other ones: give --max-residual")
# --- end of kind: truncated-rotation ------------------------------------------------------------
# --- part: cliques ------------------------------------------------------------------------------
# Graphs: of each row its neighbours, as bits. Of a clique any two rows are neighbours.


def ones(mask: int) -> Iterator[int]:
    """The places of the ones."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def colours(mask: int, near: list[int], most: int) -> int:
    """How many colours the rows need, each taking the first that no neighbour has; or most + 1."""
    count = 0
    while mask and count <= most:
        free, count = mask, count + 1
        while free:
            low = free & -free
            mask ^= low
            free &= ~(near[low.bit_length() - 1] | low)
    return count


def has_clique(
    near: list[int], rows: int, sets: list[int], count: int, look: Callable[[int], None]
) -> bool:
    """Whether so many of the rows make a clique that holds none of the sets as a whole.

    The lowest row is left out or taken; a row goes out that is the last one of a set, all others
    taken. Cliques have as many rows as colours at most. look: is told how much is done.
    """
    trail = [(rows, 0, count)]
    while trail:
        rows, taken, count = trail.pop()
        left = [T & ~taken for T in sets]
        rows &= ~sum({T for T in left if T & (T - 1) == 0})
        look(1 + rows.bit_count() + len(sets))
        if count <= 0:
            return True
        if colours(rows, near, count - 1) >= count:
            low = rows & -rows
            trail.append((rows ^ low, taken, count))
            beside = rows & near[low.bit_length() - 1]
            trail.append((beside, taken | low, count - 1))
    return False


# --- end of part: cliques -----------------------------------------------------------------------
# --- part: turns --------------------------------------------------------------------------------
# A motion that meets two pairs, see `thinning`, is nearly a turn about the line through them.

GRID = 64  # bits of frames
QUARTER = 32  # turns in a quarter: by phi with tan(phi/2) = k/32, that is c, s over d
TURNS = [(QUARTER**2 - k * k, 2 * QUARTER * k, QUARTER**2 + k * k) for k in range(QUARTER)]
AXIS = 17, 29, 43  # across which the first axis of a frame lies: a line along it has none


def turned(rows: Matrix, e: int, f: int, others: int) -> list[int]:
    """A motion that meets e and f meets, of the others, no more than those of one of these sets.

    a, b lead from e to f, p, q from e to another, ba and bp are the sums of the two bounds. Let R
    be its rotation. |b - R a| <= ba, so R = E R_phi, where R_phi takes the direction of a to that
    of b, and E turns by delta: 4 sin^2(delta/2) |a||b| = |b - R a|^2 - (|a| - |b|)^2, at most
    2 |a||b| - D, D = |a|^2 + |b|^2 - ba^2. Let R_m have the angle m that is next to phi of those
    with tan(m/2) = k / QUARTER and these plus 90, 180, 270 degrees, within 1 / QUARTER. Then
    |q - R_m p| <= bp + (2 sin(delta/2) + 1 / QUARTER) min(|p|, |q|), as |q - R p| <= bp.
    """
    a, b, reach = parted(rows[e], rows[f])
    A, B = squared(a), squared(b)
    D, size = A + B - reach**2, isqrt(A * B << 2 * GRID) + 1  # size above |a||b|
    require(D > 0, "rows {} and {} are too near to be turned about", e, f)
    tilt = isqrt((2 * size - (D << GRID) << 2 * GRID) // size) + 1 + (1 << GRID) // QUARTER
    frames, sets = (frame(a), frame(b)), [0] * (4 * QUARTER)
    for i in ones(others):
        p, q, reach = parted(rows[e], rows[i])
        short, long = sorted((squared(p), squared(q)))
        # x and y are off by less than 6 |p| and 6 |q|: nine entries by less than 2 each
        x, y = ([sum(map(mul, axis, v)) for axis in F] for F, v in zip(frames, (p, q)))
        reach = (reach << GRID) + 12 * (isqrt(long) + 1) + 1
        reach += tilt * (isqrt(short << 2 * GRID) + 1) >> GRID
        left, right, level = arc(x, y, reach)
        for k, (c, s, d) in enumerate(TURNS):
            one, other, least = left * c + right * s, right * c - left * s, level * d
            for turn, value in enumerate((one, other, -one, -other)):
                sets[4 * k + turn] |= (value >= least) << i
    return sets


def arc(x: Sequence[int], y: Sequence[int], reach: int) -> tuple[int, int, int]:
    """A, B, g: turned by phi about the third axis x is within `reach` of y iff A c + B s >= g.

    c = cos phi, s = sin phi: |x|^2 + |y|^2 - 2 (the product of y and turned x) <= reach^2.
    """
    level = squared(x) + squared(y) - reach * reach - 2 * x[2] * y[2]
    return 2 * (x[0] * y[0] + x[1] * y[1]), 2 * (x[0] * y[1] - x[1] * y[0]), level


def frame(a: list[int]) -> Matrix:
    """Three axes, one across the other, of length 2^GRID, the last along a.

    |v| 2^GRID is less than size + 1, so an entry is off by less than 2.
    """
    axes, across = list[list[int]](), crossed(a, AXIS)
    for v in (across, crossed(a, across), a):
        size = isqrt(squared(v) << 2 * GRID)
        require(size, "two rows are along the axis of all frames")
        axes.append([(k << 2 * GRID) // size for k in v])
    return axes


def parted(one: Sequence[int], other: Sequence[int]) -> tuple[list[int], list[int], int]:
    """What leads from one row to another, in both clouds, and the sum of their bounds."""
    gaps = [k - o for k, o in zip(other, one)]
    return gaps[:3], gaps[3:6], one[7] + other[7]


def crossed(a: Sequence[int], b: Sequence[int]) -> list[int]:
    """The cross product."""
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def squared(v: Sequence[int]) -> int:
    """The square of its length."""
    return sum(map(mul, v, v))


# --- end of part: turns -------------------------------------------------------------------------
# --- part: thinning -----------------------------------------------------------------------------
# Pairs i, each with a bound b_i > 0, that one motion may meet together: |y_i - R x_i - t| <= b_i.

LOOKS_MAX = 1 << 24  # at rows, groups and turns, in all stages: ten seconds of 4,096 rows
Steps = list[Any]


@dataclass(frozen=True)
class Thinning:
    """Of `alive`, a set of pairs as bits, what every motion that meets at least K of it can meet.

    near: of each pair those that one motion may meet with it; a motion meets a clique. Its own:
    of pairs that are struck together both lose the other.
    """

    rows: Matrix
    near: list[int]
    alive: int
    K: int
    looks: list[int]  # one number: how many there may be yet
    rigid: bool = False  # whether all motions keep lengths, as `turned` asks

    def after(self, steps: Steps) -> int:
        """The pairs left. A motion that meets K pairs or more of `alive` meets none struck.

        A step [e, [T, L], ...] strikes e, [[e, f], [T, L], ...] neighbours e and f: none of these
        motions meets both, so they are neighbours no longer.
        """
        alive, last = self._linked(self.alive, self.alive), len(self.rows) - 1
        for step in listed(steps):
            head, *groups = listed(step) or [None]
            met = [whole(i, last) for i in (listed(head, 2) if head.__class__ is list else [head])]
            who = " with ".join(map(str, met))
            for i in met:
                require(alive >> i & 1, "a step strikes row {} twice", i)
            pair = len(met) == 2
            require(not pair or self.near[met[0]] >> met[1] & 1, "row {} is no neighbour", who)
            require(self._apart(met, alive, groups, who), "row {} is not struck", who)
            for i, j in (met, met[::-1]) if pair else ():
                self.near[i] &= ~(1 << j)
            fewer = 1 << met[0] | 1 << met[1] if pair else self.near[met[0]]
            alive = self._linked(alive if pair else alive & ~(1 << met[0]), fewer)
        return alive

    def _apart(self, met: list[int], alive: int, groups: Steps, who: str) -> bool:
        """Whether no motion meets K pairs, these c = 1 or 2 among them, by the groups or turns.

        It misses a row of each T, a set of their common neighbours that is not met as a whole with
        them. If no r rows hit every T, it misses r + 1 rows of their union U or more, and of the
        other neighbours it meets at most as many as they have colours, if no two of one colour are
        neighbours: c + |U| - r - 1 + colours in all, less than K if r > |U| + colours + c - 1 - K.
        """
        beside, sets, union, room = alive, list[int](), 0, self.K - 1 - len(met)
        for i in met:
            beside &= self.near[i]
        for group in groups:
            T = [whole(i, len(self.rows) - 1) for i in listed(listed(group, 2)[0])]
            L = [whole(k, 1 << BITS) for k in listed(group[1])]
            mask = sum({1 << i for i in T})
            good = T and mask.bit_count() == len(T) and mask & ~beside == 0
            require(good, "a group of row {} is not of its neighbours, each once", who)
            good = len(L) == len(T) + len(met) and any(L)
            require(good, "a group of row {} is not weighed", who)
            refuted = self.refuted([self.rows[i] for i in (*met, *T)], L)
            require(refuted, "a group of row {} is not refuted", who)
            sets, union = [*sets, mask], union | mask
        most = room + len(sets) - union.bit_count()
        self._look(beside.bit_count())
        others = colours(beside & ~union, self.near, most)
        if others <= most and not self._hit(sets, union.bit_count() + others - room - 1):
            return True
        if len(met) == 2 and self.rigid and not groups:
            return self._no_turn(met[0], met[1], beside)
        return not has_clique(self.near, beside, sets, room + 1, self._look)

    def refuted(self, rows: Matrix, weights: Sequence[int]) -> bool:
        """Whether no motion meets them all: then sum w r^2 <= sum w b^2, see `weighed`."""
        squares, bound, K = weighed(rows, weights)
        return definite(raised([[-2 * k for k in row] for row in K], squares - bound))

    def _no_turn(self, e: int, f: int, beside: int) -> bool:
        """Whether `turned` leaves too few of the rows beside e and f, whatever the turn."""
        self._look(2 * QUARTER * beside.bit_count())
        for mask in {*turned(self.rows, e, f, beside)}:
            self._look(mask.bit_count())
            if colours(mask, self.near, self.K - 3) > self.K - 3:
                return False
        return True

    def _hit(self, sets: list[int], most: int) -> bool:
        """Whether so many rows, or fewer, are enough for one of each set.

        Sets without a common row need a row each; else each row of the first is tried.
        """
        trail = [(sets, most + 1, 1 << len(self.rows))]  # it begins with a row of no set
        while trail:
            left, most, tried = trail.pop()
            self._look(1 + len(left))
            low = tried & -tried
            trail += [(left, most, tried ^ low)] * (tried != low)
            left, most, apart, taken = [T for T in left if not T & low], most - 1, 0, 0
            for mask in left:
                if not mask & taken:
                    apart, taken = apart + 1, taken | mask
            if apart <= most and not left:
                return True
            if apart <= most:
                trail.append((left, most, left[0]))
        return False

    def _look(self, count: int) -> None:
        self.looks[0] -= count
        require(self.looks[0] >= 0, "the stages take more than {} looks", LOOKS_MAX)

    def _linked(self, alive: int, fewer: int) -> int:
        """Less those with fewer than K - 1 neighbours, until none is left that has so few.

        fewer: those that have lost a neighbour; all, at first.
        """
        while fewer := fewer & alive:
            self._look(fewer.bit_count())
            few = [i for i in ones(fewer) if (self.near[i] & alive).bit_count() < self.K - 1]
            alive, fewer = alive & ~sum(1 << i for i in few), 0
            for i in few:
                fewer |= self.near[i]
        return alive


def listed(value: Any, count: int | None = None) -> list[Any]:
    """The entries of a list, of so many."""
    good = value.__class__ is list and (count is None or len(value) == count)
    require(good, "a stage, a step or a group is not a list of the right length")
    return value


def whole(value: Any, most: int) -> int:
    """The number; RefusalError if it is none of 0, 1, ..., most."""
    require(value.__class__ is int and 0 <= value <= most, "a number of the stages is out of range")
    return value


def raised(A: Matrix, by: int) -> Matrix:
    """A + by I."""
    return [[k + by * (i == j) for j, k in enumerate(row)] for i, row in enumerate(A)]


def weighed(rows: Matrix, weights: Sequence[int]) -> tuple[int, int, Matrix]:
    """S, B, K: motions with M sum w r^2 <= B have 2 p^T K p >= S - B, p their unit quaternion.

    B = M sum w b^2, M = sum w: for the best shift, M sum w r^2 is S - 2 p^T K p.
    """
    x, y, bound, K = weighed_parts(rows, weights)
    return x + y, bound, K


def weighed_parts(rows: Matrix, weights: Sequence[int]) -> tuple[int, int, int, Matrix]:
    """S in two parts, of x and of y, before B and K."""
    first, m, bound = rows[0], [[0] * 7 for _ in range(7)], 0
    for row, w in zip(rows, weights):
        a = [1, *[k - o for k, o in zip(row[:6], first)]]
        bound += w * row[7] ** 2
        for i, left in enumerate(a):
            for j in range(i, 7 if i < 4 else i + 1):
                m[i][j] += w * left * a[j]
    x, y = spreads(m)
    return x, y, m[0][0] * bound, davenport(cross(m))


def consistent(rows: Matrix) -> list[int]:
    """Of each row those that one motion may meet with it.

    It keeps lengths: | |xj - xi| - |yj - yi| | <= bi + bj = d. With A, B the squared lengths and
    D = A + B - d^2 that is false iff A + B - 2 sqrt(A B) > d^2, iff D > 0 and D^2 > 4 A B.
    """
    near = [0] * len(rows)
    for i, (a, b, c, f, g, h, _, u) in enumerate(rows):
        own, bit = 0, 1 << i
        for j, (k, l, m, o, p, q, _, v) in enumerate(rows[:i]):
            A = (a - k) ** 2 + (b - l) ** 2 + (c - m) ** 2
            B = (f - o) ** 2 + (g - p) ** 2 + (h - q) ** 2
            D = A + B - (u + v) ** 2
            if D <= 0 or D * D <= 4 * A * B:
                own |= 1 << j
                near[j] |= bit
        near[i] |= own
    return near


# --- end of part: thinning ----------------------------------------------------------------------
# --- part: scales -------------------------------------------------------------------------------
# Pairs that motions with a scale s may meet together: |y_i - s R x_i - t| <= b_i.


@dataclass(frozen=True)
class ScaledThinning(Thinning):
    """The same of motions with a scale from low to high, None: without an end."""

    low: int = 0
    high: int | None = None

    def refuted(self, rows: Matrix, weights: Sequence[int]) -> bool:
        """Whether no such motion meets them all: then sum w r^2 <= sum w b^2."""
        x, y, bound, K = weighed_parts(rows, weights)
        return scaled_refuted(x, y - bound, K, self.low, self.high)


def between(low: Fraction, high: Fraction | None) -> str:
    """Two numbers in words, rounded outwards."""
    above = "on" if high is None else f"to {rounded(high, 9):g}"
    return f"from {rounded(low, 9, ROUND_FLOOR):g} {above}"


def scaled(rows: Matrix, s: int, one: int) -> Matrix:
    """The rows with x times s, y and b times `one`: a scale k/one is then k."""
    return [[*[s * k for k in r[:3]], *[one * k for k in r[3:6]], r[6], one * r[7]] for r in rows]


def longer(A: int, B: int, d: int) -> bool:
    """Whether sqrt(A) > sqrt(B) + d, d >= 0: iff G = A - B - d^2 > 0 and G^2 > 4 d^2 B."""
    G = A - B - d * d
    return G > 0 and 4 * d * d * B < G * G


def scaled_refuted(x: int, c: int, K: Matrix, low: int, high: int | None) -> bool:
    """Whether s^2 x + c > 2 s l for all s from low to high, l >= 0 the largest eigenvalue of K.

    By 2 l, (s x + c/s) falls with s up to sqrt(c/x), where it is 2 sqrt(c x), and grows from there.
    """
    if c > low * low * x and x and (high is None or c < high * high * x):
        level, times = isqrt(c * x), 1
    else:
        end = high if c > low * low * x and x and high is not None else low
        level, times = end * end * x + c, 2 * end
    return definite(raised([[-times * k for k in row] for row in K], level))


def graphs(rows: Matrix, ends: list[int]) -> Iterator[list[int]]:
    """Of each piece, of each row those that one motion with a scale of the piece may meet with it.

    With a = |xj - xi|, b = |yj - yi|, d = bi + bj it makes b of s a, but for d: s a <= b + d and
    b <= s a + d. So low a <= b + d and b <= high a + d: false up to a piece, and from one on.
    Roots tell which ends are on one side for certain; only those between are tried exactly.
    """
    last, squares = len(ends), [end * end for end in ends]
    flips = [[0] * len(rows) for _ in range(last + 2)]
    for i, row in enumerate(rows):
        for j, other in enumerate(rows[:i]):
            p, q, d = parted(row, other)
            A, B = squared(p), squared(q)
            a, b = isqrt(A), isqrt(B)
            # s (a + 1) < b - d: s is too small; s a >= b + 1 - d: it is not
            least = bisect_left(ends, -((d - b) // (a + 1)))
            most = bisect_left(ends, -((d - b - 1) // a), least) if a else last
            first = bisect_left(
                squares, 0, least, most, key=lambda s, A=A, B=B, d=d: -longer(B, s * A, d)
            )
            # s (a + 1) <= b + d: s is not too large; s a >= b + 1 + d: it is
            least = bisect_left(ends, (b + d) // (a + 1) + 1)
            most = bisect_left(ends, (b + d) // a + 1, least) if a else last
            after = bisect_left(
                squares, 1, least, most, key=lambda s, A=A, B=B, d=d: longer(s * A, B, d)
            )
            for piece in (first, after + 1):
                flips[piece][i] ^= 1 << j
                flips[piece][j] ^= 1 << i
    return accumulate(flips[:-1], lambda one, two: [*map(int.__xor__, one, two)])


# --- end of part: scales ------------------------------------------------------------------------
# --- part: labels -------------------------------------------------------------------------------
# For kinds that claim of pairs with bounds which of them the motions meet that meet most.

ROWS_MAX = 4096  # bounds the time: each two are held against each other
ROWS_BITS = 1 << 20  # of the largest number, times the rows: fifteen seconds, seven where 70 do
LEAST = 3  # pairs to meet: any two are met by some motion, or refuted at once
Document = dict[str, Any]
TYPES.update(Steps=list, Document=dict)


@dataclass(frozen=True)
class LabelledStatement(Statement):
    """A witness that meets K pairs; labels: of each pair "i", "o" or "?", where not proved.

    fit: a certificate of the least squares over the pairs that the witness meets, without data.
    """

    n: int
    data: str | None
    digest: str
    quaternion: tuple[int, int, int, int]  # of any length
    shift: tuple[int, int, int, int]  # three integers, the exponent of their unit
    labels: str
    upper: int
    fit: Document | None
    sin2_half_angle: Fraction | None
    tau: Fraction | None

    def met(self, m: Matrix, e: int) -> list[int]:
        """The rows that the witness meets, exactly: so many as are needed, or more."""
        w, x, y, z = q = self.quaternion
        *t, exponent = self.shift
        norm, low = sum(c * c for c in q), min(e, exponent)
        require(norm and abs(exponent) <= EXPONENT_MAX, "witness is no motion")
        R = [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
        t, unit, met = [norm * k << exponent - low for k in t], e - low, list[int]()
        for i, row in enumerate(m):
            turned = [sum(map(mul, line, row)) for line in R]
            off = [((norm * b - a) << unit) - k for a, b, k in zip(turned, row[3:6], t)]
            require(row[7] > 0 <= row[6], "row {} has a bound <= 0 or a weight < 0", i)
            if sum(c * c for c in off) <= (norm * row[7] << unit) ** 2:
                met.append(i)
        require(len(met) >= LEAST, "the witness meets {} pairs: {} needed", len(met), LEAST)
        return met

    def require_claims(self, sure: int, first: int, upper: int) -> None:
        """RefusalError where inliers are not of `sure`, outliers of `first`, the bound is lower."""
        require(len(self.labels) == self.n, "claims.labels is not of n pairs")
        proved = {"i": sure, "o": ~first, "?": -1}
        for i, label in enumerate(self.labels):
            require(proved.get(label, 0) >> i & 1, "claims.labels: that of row {} is not proved", i)
        require(self.upper >= upper, "claims.upper is below the proved bound {}", upper)

    def fitted(self, m: Matrix, e: int, met: list[int], kinds: str, model: str = "") -> Outcome:
        """What `fit`, of one of the kinds, proves of the pairs that the witness meets."""
        if self.fit is None:
            return Outcome(verified=True)
        require(self.fit.get("kind") in kinds.split(), "fit is of another kind")
        spans = (0, 1, 2), (3, 4, 5), (range(8, 14) if len(m[0]) > 8 else (6,))
        x, y, w = (array("d", [ldexp(m[i][k], e) for i in met for k in span]) for span in spans)
        fit = check(json.dumps(self.fit).encode(), Clouds(x, y, w, model))
        require(fit.verified, "fit is refused: {}", fit.reason)
        return fit

    def reach(self, level: int, size: int, K: Matrix, count: int) -> Iterator[str]:
        """Where all motions that meet so many pairs have level <= 2 p^T K p, see `weighed`.

        If level I - 2 K + t (u u^T - (1 - s) I) > 0, t = tau size > 0, u = q/|q| of the fit, then
        0 < t ((u.p)^2 - (1 - s)), that is sin^2(a/2) < s.
        """
        s, tau, fit = self.sin2_half_angle, self.tau, self.fit or {}
        q = fit.get("proof", fit).get("pose")
        if s is None and tau is None:
            return
        if not (s and tau and q):
            raise RefusalError("reach is not of a fit, sin2_half_angle and tau")
        d, (a, b) = s.denominator, tau.as_integer_ratio()
        norm = sum(c * c for c in q)
        least = (level * b * d - a * size * (d - s.numerator)) * norm
        parts = zip(q, K)
        A = [[a * d * size * i * j - 2 * b * d * norm * k for j, k in zip(q, r)] for i, r in parts]
        require(a > 0 < s.numerator < d and definite(raised(A, least)), "reach is not proved")
        angle = Fraction(2) * root_up(s.numerator, d - s.numerator)  # a/2 < tan(a/2)
        yield (
            f"Every motion that brings these {count} within has its rotation within "
            f"{rounded(angle * DEGREES, 3):.2e} degrees of R, that of the pose below."
        )

    def outcome(self, words: Sequence[str], K: int, fit: Outcome) -> Outcome:
        """The theorems, those of the fit after the others."""
        words = [*words, *[f"Of the least squares over these {K} pairs:"] * bool(fit.theorems)]
        last = "Not proved: anything under `about`, and where the points come from."
        theorems = (*[w for w in (*words, *fit.theorems) if w != last], last)
        undecided = self.labels.count("?")
        return Outcome(verified=True, undecided=undecided, weigh=fit.weigh, tell=lambda: theorems)


def staged(
    stages: Steps, near: list[int], K: int, thin: Callable[[list[int], int, int], Thinning]
) -> tuple[int, int, int]:
    """What is left of all pairs after the first stage; no motion meets more; which pairs are met.

    The latter by every motion that meets K: so few pairs but one of them are left that fewer than K
    can be met. What the first stage strikes together no motion meets in any other, either. thin: of
    neighbours, a set of pairs and a number of them.
    """
    n = len(near)
    first = alive = (1 << n) - 1
    last, upper, sure = K, n, 0
    for number, stage in enumerate(stages):
        least, without, steps = listed(stage, 3)
        k, i = whole(least, n + 1), whole(without, n)
        require(k == K if number == 0 or i < n else k >= last, "a stage is misplaced")
        require(number or i == n, "the first stage leaves a pair out")
        thinning = thin([*near], first & ~(1 << i) if i < n else alive, k)
        left = thinning.after(steps)
        if i < n:
            sure |= (left.bit_count() < K) << i
            continue
        alive, last, upper = left, k, min(upper, max(k - 1, left.bit_count()))
        first, near = (first, near) if number else (left, thinning.near)
    return first, upper, sure


def bounded_rows(doubles: bytes | memoryview, n: int, width: int = 8) -> tuple[Matrix, int]:
    """A row x1, x2, x3, y1, y2, y3, w, b of integers for each pair, and e: all times 2^e."""
    require(n <= ROWS_MAX, "more than {} pairs", ROWS_MAX)
    (k,), e = _integers(doubles, [0], width * n, EXPONENT_MAX)
    size = max(map(abs, k)).bit_length()
    require(size * n <= ROWS_BITS, "the data hold numbers of too many sizes for {} pairs", n)
    columns = [k[3 * n * c + i : 3 * n * (c + 1) : 3] for c in (0, 1) for i in (0, 1, 2)]
    others = [k[7 * n + i :: width - 7] for i in range(width - 7)]
    return [list(row) for row in zip(*columns, k[6 * n : 7 * n], *others)], e


def sprung_rows(doubles: bytes | memoryview, n: int) -> tuple[Matrix, int]:
    """The same with 1 for a weight, and after the bound the six entries of L."""
    rows, e = bounded_rows(doubles, n, 13)
    return [[*row[:6], 1, *row[6:]] for row in rows], e


BOUNDED = (
    2,
    bounded_rows,
    "bounds or weights are others, or not given: as for certify give --max-residual",
)
# --- end of part: labels ------------------------------------------------------------------------
# --- kind: consensus ----------------------------------------------------------------------------
# Pair i has a bound b_i > 0; a motion (R, t) meets it if |y_i - R x_i - t| <= b_i. Claimed: no one
# meets more than so many pairs; which pairs all motions that meet K or more of them meet, K as many
# as the witness does, and which pairs none.

CONSENSUS = b"certreg-consensus/1\0"
SPRUNG = b"certreg-consensus-springs/1\0"


@dataclass(frozen=True)
class ConsensusStatement(LabelledStatement):
    """witness, stages, tau make the proof.

    springs: true where the least squares are of general springs, which change no bound.
    """

    kind: ClassVar = "consensus"
    keys: ClassVar = {
        "": "about claims fit format kind problem reach? springs? stages witness",
        "claims": "labels upper",
        "problem": "data digest n",
        "reach?": "sin2_half_angle tau",
        "witness": "quaternion shift",
    }
    model: ClassVar[str] = "--max-residual"

    stages: Steps
    springs: bool | None

    @property
    def prefix(self) -> bytes:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Of one's own where a pair has a spring, and no weight."""
        return SPRUNG if self.springs else CONSENSUS

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """All claims, of rows (x, y, w, b) over 2^e; L follows where there are springs.

        With K = |I| of the set I that the witness meets, every motion that meets K pairs or more
        meets none outside of the first stage's set C: those are outliers. Where C = I, every such
        motion meets just I. Where so few pairs but i are left that fewer than K of them can be met,
        every such motion meets i: an inlier.
        """
        del equal  # weights are of the fit alone
        met = self.met(m, e)
        K, looks, within = len(met), [LOOKS_MAX], sum(1 << i for i in met)
        first, upper, sure = staged(
            self.stages,
            consistent([row[:8] for row in m]),
            K,
            lambda near, alive, k: Thinning(m, near, alive, k, looks, rigid=True),
        )
        self.require_claims(within if first == within else sure, first, upper)
        fit = self.fitted(m, e, met, "springs-sos springs-cones" if self.springs else "isotropic")
        squares, bound, form = weighed([m[i] for i in met], [m[i][6] for i in met])
        reach = self.reach(squares - bound, squares, form, K)
        bounds = bounds_worth(m, [row[7] for row in m], e)
        return self.outcome([*self._words(K, bounds), *reach], K, fit)

    def _words(self, K: int, bounds: Iterator[str]) -> Iterator[str]:
        n, out, sure = self.n, self.labels.count("o"), self.labels.count("i")
        held = "a bound and a spring" if self.springs else "a bound"
        yield f"Data: n = {n} pairs, each with {held}. SHA-256 of their doubles is {self.digest}."
        if self.springs:
            yield "A bound is on the distance of the two points of a pair, whatever its spring."
        yield from bounds
        yield f"One rigid motion brings {K} of the {n} pairs within their bounds."
        yield f"No rigid motion brings more than {self.upper} within."
        if sure + out == n:
            yield f"Every motion that brings {K} within brings these {K} within, and only these."
        yield f"In EVERY motion that brings {K} within: outliers: {out}, inliers: {sure}."
        if sure + out < n:
            yield f"Not proved: which of the other {n - sure - out} pairs are."


SUMS[CONSENSUS] = BOUNDED
SUMS[SPRUNG] = (
    7,
    sprung_rows,
    "bounds or springs are others, or not given: as for certify give --max-residual and springs",
)
# --- end of kind: consensus ---------------------------------------------------------------------
# --- kind: consensus-similarity -----------------------------------------------------------------
# As of the kind consensus, of motions with a scale: (s, R, t), s > 0, meets pair i if
# |y_i - s R x_i - t| <= b_i. The scales are cut into pieces, and each is treated by itself.

GRAPHS_MAX = 1 << 30  # bits of the graphs of all pieces
SCALE_BITS = 8192  # of the ends of pieces over their unit: of doubles a quotient needs 4,200
ENDS_BITS = 1 << 20  # the same times the pairs: each two are held against ends, squared
NONE, SAME, OPEN = "-=?"  # of a piece: no motion meets K; those that do meet just I; not proved


@dataclass(frozen=True)
class ConsensusSimilarityStatement(LabelledStatement):
    """witness, with its scale `factor`, and pieces make the proof.

    A piece: its end, as a dyadic, and stages; it begins at the end of the one before, the first at
    0, and the last has no end, null. states: what is claimed of each piece, a letter.
    scale: of the least squares over the pairs that the witness meets, as in the kind similarity.
    """

    kind: ClassVar = "consensus-similarity"
    keys: ClassVar = {
        "": "about claims fit format kind pieces problem reach? scale witness",
        "claims": "labels scale_lower scale_upper states upper",
        "problem": "data digest n",
        "reach?": "sin2_half_angle tau",
        "witness": "factor quaternion shift",
    }
    prefixes: ClassVar = {
        "asymmetric": b"certreg-consensus-similarity/1\0",
        "symmetric": b"certreg-consensus-similarity-symmetric/1\0",
    }

    factor: Fraction
    pieces: Steps
    states: str
    scale: str
    scale_lower: Fraction  # and upper: of all motions that meet the pairs that the witness meets
    scale_upper: Fraction

    @property
    def prefix(self) -> bytes:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Of the two problems, each its own; an unknown one is refused in `prove`."""
        return self.prefixes.get(self.scale, self.prefixes["symmetric"])

    @property
    def model(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Both options."""
        return f"--scale {shown(self.scale)} --max-residual"

    def prove(self, m: Matrix, e: int, *, equal: bool) -> Outcome:
        """All claims, of rows (x, y, w, b) over 2^e.

        I: the K pairs that the witness meets. In each piece every motion that meets K pairs or more
        meets none outside of the first stage's set: none does where that has fewer than K, and each
        meets just I where that is I. What holds in every piece holds of all motions with a scale.
        """
        del equal  # weights are of the fit alone
        require(self.scale in self.prefixes, "scale is neither asymmetric nor symmetric")
        require(self.factor > 0, "the witness has no scale > 0")
        s, t = self.factor.as_integer_ratio()
        met = self.met(scaled(m, s, t), e - t.bit_length() + 1)
        ends, K, within = self._ends(), len(met), sum(1 << i for i in met)
        one = max([end.denominator for end in ends], default=1)
        highs = [int(end * one) for end in ends]
        most = min(SCALE_BITS, ENDS_BITS // self.n)
        fine = max(end.bit_length() for end in (one, *highs)) <= most
        require(fine, "an end of a piece has more than {} bits", most)
        rows, parts, looks = scaled(m, 1, one), zip([0, *highs], [*highs, None]), [LOOKS_MAX]
        union, most, sure, states = 0, K, (1 << len(m)) - 1, ""
        for near, (low, high), piece in zip(graphs(rows, highs), parts, self.pieces):
            first, upper, own = staged(
                listed(piece[1]),
                near,
                K,
                lambda near, alive, k, a=low, b=high: ScaledThinning(
                    rows, near, alive, k, looks, low=a, high=b
                ),
            )
            most = max(most, upper)
            states += NONE if first.bit_count() < K else SAME if first == within else OPEN
            if states[-1] != NONE:
                union, sure = union | first, sure & (within if first == within else own)
        allowed = {NONE: NONE + SAME + OPEN, SAME: SAME + OPEN, OPEN: OPEN}
        good = len(self.states) == len(states) and all(
            claim in allowed[true] for claim, true in zip(self.states, states)
        )
        require(good, "claims.states is wrong, proved is {}", states)
        self.require_claims(sure, union, most)
        fit = self.fitted(m, e, met, "similarity", f"--scale {self.scale}")
        reach = self._scales([m[i] for i in met])
        bounds = bounds_worth(m, [row[7] for row in m], e, scales=True)
        return self.outcome([*self._words(K, ends, bounds), *reach], K, fit)

    def _ends(self) -> list[Fraction]:
        """Of all pieces but the last."""
        pieces = [listed(piece, 2) for piece in self.pieces]
        good = len(pieces) * self.n**2 <= GRAPHS_MAX and bool(pieces) and pieces[-1][0] is None
        require(good, "the last piece has an end, or there are too many")
        pairs = [listed(end, 2) for end, _ in pieces[:-1]]
        require({int} >= {*map(type, chain(*pairs))}, "an end of a piece is no dyadic")
        ends = [_dyadic(*pair) for pair in pairs]
        good = all(low < high for low, high in zip([Fraction(0), *ends], ends))
        require(good, "the ends of the pieces do not increase from 0 on")
        return ends

    def _scales(self, rows: Matrix) -> Iterator[str]:
        """A motion with the scale s that meets these has s^2 x + c <= 2 s p^T K p, c = y - B.

        So p^T K p >= sqrt(c x), if c >= 0.
        """
        low, high = self.scale_lower, self.scale_upper
        one = max(low.denominator, high.denominator)
        x, y, bound, K = weighed_parts(scaled(rows, 1, one), [row[6] for row in rows])
        a, b, c = int(low * one), int(high * one), y - bound
        good = 0 <= a < b and (a == 0 or scaled_refuted(x, c, K, 0, a))
        require(good, "claims.scale_lower is not proved")
        require(scaled_refuted(x, c, K, b, None), "claims.scale_upper is not proved")
        yield f"Every motion that brings these {len(rows)} within has a scale {between(low, high)}."
        require(c >= 0 or self.tau is None, "reach is not proved")
        yield from self.reach(2 * isqrt(max(c, 0) * x), isqrt(x * y), K, len(rows))

    def _words(self, K: int, ends: list[Fraction], bounds: Iterator[str]) -> Iterator[str]:
        n, out, sure = self.n, self.labels.count("o"), self.labels.count("i")
        motion = "motion with a scale"
        yield f"Data: n = {n} pairs, each with a bound. SHA-256 of their doubles is {self.digest}."
        yield from bounds
        size = f"{rounded(self.factor, 9):g}, rounded up here"
        yield f"One {motion}, {size}, brings {K} of the {n} pairs within their bounds."
        yield f"No {motion} brings more than {self.upper} within, whatever the scale."
        if out + sure == n:
            yield f"Every {motion} that brings {K} within brings these {K} within, and only these."
        parts = [*zip([Fraction(0), *ends], [*ends, None])]
        yield f"In EVERY {motion} that brings {K} within: outliers: {out}, inliers: {sure}."
        around = zip(f"={self.states}", self.states, f"{self.states[1:]}=", parts)
        runs = [(a, b, c, low, high) for a, b, c, (low, high) in around if b == OPEN]
        lows = [low for before, _, _, low, _ in runs if before != OPEN]
        highs = [high for _, _, after, _, high in runs if after != OPEN]
        for low, high in zip(lows, highs):
            place = between(low, high)
            yield f"Not proved: which {K} pairs or more are met with a scale {place}."
        if lows:
            yield f"With any other scale: these {K} and only these, where {K} or more are met."
        if out + sure < n:
            yield f"Not proved: which of the other {n - sure - out} pairs are."


SUMS.update(dict.fromkeys(ConsensusSimilarityStatement.prefixes.values(), BOUNDED))
# --- end of kind: consensus-similarity ----------------------------------------------------------
FORMS = IsotropicStatement, SimilarityStatement, CountStatement, SpringsSosStatement
LAST = SpringsConesStatement, SpringsListStatement, TruncatedRotationStatement, ConsensusStatement
LATEST = (ConsensusSimilarityStatement,)
KINDS: dict[str, type[Statement]] = {form.kind: form for form in (*FORMS, *LAST, *LATEST)}

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
