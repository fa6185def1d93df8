"""The table of what ctypes is told of C's functions, beside their prototypes in the headers."""

from __future__ import annotations

import ctypes
import re
from pathlib import Path

import pytest

from certreg.native import kernels
from certreg.native.signatures import WRITTEN, Prototype, prototypes

ROOT = Path(__file__).parents[2]
TYPES = {
    "void": None,
    "double": ctypes.c_double,
    "int": ctypes.c_int,
    "int32_t": ctypes.c_int32,
    "int64_t": ctypes.c_int64,
}
DECLARED = re.compile(
    r"^(?:CERTREG_LINKAGE )?([\w ]+?\**) ?\b(certreg_\w+|LOOP|RULE)\(([^()]*)\)(?:;|\s*\{)",
    re.MULTILINE,
)
COUNTS = r"n|count|counts|rows|size|words|steps|points|taken|escapes"


def type_of(words: str) -> object:
    """Of an argument or a result; arrays and arrays by name are addresses."""
    if "*" in words or "[" in words or "certreg_fixed_numbers" in words:
        return ctypes.c_void_p
    bare = [word for word in words.replace("const", "").split() if word in TYPES]
    return TYPES[bare[0]]


def declared_in(text: str) -> dict[str, Prototype]:
    """The prototypes of C that is written as ours is."""
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    found: dict[str, Prototype] = {}
    for result, name, arguments in DECLARED.findall(text):
        if result[0].isspace() or result.startswith("static"):
            continue  # a call, and what stays within its unit
        listed = [] if arguments.strip() == "void" else arguments.split(",")
        found[name] = Prototype(type_of(result), tuple(map(type_of, listed)))
    return found


def declared() -> dict[str, Prototype]:
    """Of all headers, and of the loops, each of which a unit names before it includes them."""
    found: dict[str, Prototype] = {}
    for header in kernels.HEADERS:
        found |= declared_in(header.read_text("utf-8"))
    for name in ("LOOP", "RULE"):
        loop = found.pop(name)
        for unit in kernels.UNITS:
            named = re.findall(rf"#define {name} (\w+)", unit.read_text("utf-8"))
            found |= dict.fromkeys(named, loop)
    return found


def test_every_function_that_is_called_is_declared_as_its_header_says():
    headers = declared()

    assert {name: headers.get(name) for name in prototypes()} == prototypes()


@pytest.mark.parametrize(
    "planted",
    [
        "int certreg_next(struct certreg_thinning *thinning);",
        "int64_t certreg_next(struct certreg_thinning *thinning, int64_t row);",
        "int64_t certreg_next(int64_t row);",
        "void certreg_next(struct certreg_thinning *thinning);",
    ],
)
def test_a_prototype_that_differs_is_seen(planted):
    assert declared_in(planted)["certreg_next"] != WRITTEN["certreg_next"]


def test_no_function_is_called_that_is_not_in_the_table():
    """Neither by its name on a library, nor by one that is made of parts (`run` of library.py)."""
    called: set[str] = set()
    for path in (ROOT / "certreg").rglob("*.py"):
        if path.name != "signatures.py":
            called.update(re.findall(r"\.(certreg_\w+)", path.read_text("utf-8")))

    assert called - {"certreg_level"} <= set(prototypes())
    assert len(called) > 25


def test_every_argument_that_counts_has_64_bits():
    """What is named a count, a size or a number of rows; `int` is for codes, flags and lanes."""
    counts = re.compile(
        r"\bint (?:\*\s*)?(?:n|count|counts|rows|size|words|steps|points|taken|escapes)\b"
    )
    for header in kernels.HEADERS:
        text = header.read_text("utf-8")
        own = re.sub(r"static inline.*?\n\}", "", text, flags=re.DOTALL)
        assert not counts.search(own), header.name
