"""Why a certificate is refused, and what to type: other clouds than its own, or a mere result.

The checker refuses by itself, whatever is said here; it has no words to spare for a remedy.
"""

from __future__ import annotations

import base64
import os
import re
import struct
from array import array
from collections.abc import Iterator, Sequence
from pathlib import Path

from certreg.exact.dyadic import sigma_of_weight
from certreg.verify import (
    CONSENSUS,
    SPRUNG,
    TRUNCATED,
    Clouds,
    ConsensusSimilarityStatement,
    Statement,
    parse,
    shown,
)

WEIGHED = (("weight", 1), ("bound", 1))
COLUMNS = {  # of the doubles behind the points, and how many of each a pair has
    CONSENSUS: WEIGHED,
    TRUNCATED: WEIGHED,
    **dict.fromkeys(ConsensusSimilarityStatement.prefixes.values(), WEIGHED),
    SPRUNG: (("bound", 1), ("spring", 6)),
}
OPTIONS = re.compile(r"--\w[\w-]*(?: (?!--)\S+)?")
BOUND, TRUNCATING = "--max-residual", "--objective truncated"
BINDING = ("the certificate has ", "the certified ", "the certificate is about another number")
SPRINGS = "--springs KIND, --normals FILE or others"


def told_apart(reason: str, certificate: bytes, clouds: Clouds) -> str:
    """The reason of a refusal, in words that name what differs where pairs have bounds."""
    if not reason.startswith(BINDING):
        return reason
    statement = parse(certificate)
    if statement.prefix in COLUMNS and statement.data is not None:
        return next(_differences(statement, clouds), reason)
    bounded = BOUND in _options(clouds.model)
    return _other_options(statement, clouds, ()) if bounded else reason


def _differences(statement: Statement, clouds: Clouds) -> Iterator[str]:
    """In words, that of the options first, then of the numbers of pairs, then of these."""
    own = _columns(statement)
    if clouds.model != statement.model:
        yield _other_options(statement, clouds, own["bound"])
    n, given = statement.n, len(clouds.source) // 3
    if given != n:
        yield f"the certificate is about {n} pairs, given are {given}"
    if clouds.weights is None:
        return
    if len(clouds.weights) != sum(map(len, own.values())):
        has = "a spring for each pair, none is" if "spring" in own else "no springs, some are"
        ask = f"give {SPRINGS}, as for certify" if "spring" in own else "leave them out"
        yield f"the certificate has {has} given: {ask}"
        return
    theirs = _split(clouds.weights, statement)
    for name in ("bound", "weight", "spring"):
        if name in own and own[name] != theirs[name]:
            yield _other_values(name, own[name], theirs[name], n)


def _columns(statement: Statement) -> dict[str, Sequence[float]]:
    """The bounds, and the weights or springs, that a certificate holds."""
    held = base64.b64decode(statement.data or "")
    count = statement.n * sum(size for _, size in COLUMNS[statement.prefix])
    return _split(array("d", struct.unpack(f"<{count}d", held[-8 * count :])), statement)


def _split(doubles: Sequence[float], statement: Statement) -> dict[str, Sequence[float]]:
    """The doubles behind the points, by what they are."""
    found: dict[str, Sequence[float]] = {}
    for name, size in COLUMNS[statement.prefix]:
        found[name], doubles = doubles[: size * statement.n], doubles[size * statement.n :]
    return found


def _other_options(statement: Statement, clouds: Clouds, bounds: Sequence[float]) -> str:
    """What the certificate is with, what was given, and what to add or to leave out."""
    own, given = (_options(model) for model in (statement.model, clouds.model))
    certified, typed = _valued(own, bounds), _valued(given, _given_bounds(clouds))
    more = [one for one in certified if one not in typed]
    less = [one for one in given if one not in own]
    todo = [f"give {' '.join(more)}"] * bool(more) + [f"leave {' '.join(less)} out"] * bool(less)
    made, was = " ".join(certified) or "no such option", " ".join(typed) or "none"
    return f"the certificate was made with {made}, given is {was}: {', '.join(todo)}"


def _valued(options: list[str], bounds: Sequence[float]) -> list[str]:
    """The same with the bound, where that is one number for all pairs."""
    value = f"{bounds[0]!r}" if bounds and _alike(bounds) else "FILE"
    return [f"{BOUND} {value}" if one == BOUND else one for one in options]


def _given_bounds(clouds: Clouds) -> Sequence[float]:
    """The bounds that were given: behind the weights, or before the springs, of all pairs."""
    numbers, n = clouds.weights, len(clouds.source) // 3
    if numbers is None:
        return ()
    return numbers[n:] if len(numbers) == n + n else numbers[:n]


def _options(model: str) -> list[str]:
    """The options of a model; the bound is told of truncated squares, too."""
    found = OPTIONS.findall(model)
    return [*found, BOUND] if TRUNCATING in found else found


def _other_values(name: str, own: Sequence[float], given: Sequence[float], n: int) -> str:
    """Which is the first that differs, how many do, and what to give."""
    size = len(own) // n
    starts = range(0, size * n, size)
    rows = [k // size for k in starts if own[k : k + size] != given[k : k + size]]
    row, others = rows[0], f" ({len(rows)} of {n} {name}s differ)"
    if name == "spring":
        told = f"the certified spring of row {row} (from 0) is not the given one{others}"
        return f"{told}: give {SPRINGS}, as for certify"
    place = "" if _alike(own) and _alike(given) else f" of row {row} (from 0)"
    told = f"the certified {name}{place} is {own[row]!r}, given is {given[row]!r}"
    if name == "bound":
        remedy = f"give {BOUND} {own[0]!r}" if _alike(own) else f"give {BOUND} FILE, as for certify"
    else:
        remedy = _weight_remedy(own)
    return f"{told}{others if place else ''}: {remedy}"


def _weight_remedy(weights: Sequence[float]) -> str:
    """The option by which all pairs get such a weight, where there is one."""
    w = weights[0]
    if not _alike(weights):
        return "give --weights FILE, as for certify"
    if w == 1.0:
        return "leave --sigma and --weights out"
    sigma = sigma_of_weight(w)
    alone = "give --sigma or --weights, as for certify"
    return alone if sigma is None else f"give --sigma {sigma!r}"


def _alike(values: Sequence[float]) -> bool:
    return all(value == values[0] for value in values)


# As results are written: on one line in a list's, else not.
RESULT = re.compile(rb'\s*\{\s*"schema"\s*:\s*"(certreg-result/\d+)"')
HEAD = 256  # bytes of a file that are looked at
FOLDER = "certificates"  # beside the results of a list


def why_no_certificate(reason: str, content: bytes) -> str:
    """The reason of a refusal, in words that say so where the content is a result."""
    found = RESULT.match(content[:HEAD])
    if found is None:
        return reason
    return (
        f"this is a result ({found[1].decode()}), not a certificate: give the certificate.json "
        "that certify --out wrote beside it"
    )


def why_no_certificates(path: str | os.PathLike[str]) -> str | None:
    """Why no line of a file is a certificate, where its first is a result; else None."""
    try:
        if not Path(path).is_file():  # of a pipe nothing is taken away, for one nobody waits
            return None
        with Path(path).open("rb") as file:
            found = RESULT.match(file.read(HEAD))
    except (OSError, ValueError):  # which the checker tells
        return None
    if found is None:
        return None
    beside = Path(path).parent / FOLDER
    place = shown(beside) if beside.is_dir() else f"the folder {FOLDER} that batch wrote"
    return (
        f"these are results ({found[1].decode()}), not certificates: give one of the files in "
        f"{place}, one for each pair"
    )
