"""Records, offsets in headers, what ctypes is told, and the C that reads and writes them agree."""

from __future__ import annotations

import ctypes
import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from engines import c_compiler

from certreg.native import eigenbasis, kernels, layout, library, sums
from certreg.native.codegen.records import RecordLayout, layout_files
from certreg.native.engine import current_engine
from certreg.native.kernels import GENERATED, HERE
from certreg.native.layout import (
    BASIN,
    BODY,
    ENERGIES,
    MATRIX_STATE,
    QUATERNION_STATE,
    named,
    plain,
    record_of,
    record_types,
    symmetric,
    width,
)
from certreg.native.loops import Ending
from certreg.native.signatures import WRITTEN, Prototype, prototypes
from certreg.problem import fast_pose, floating_sums
from derivations import breathing_emit, emit, motion, spring_emit, spring_motion

RECORDS = {
    record.name: record
    for record in (*emit.records(), *breathing_emit.records(), *spring_emit.records())
}
STRUCTS = {  # of handwritten headers, as Python passes them
    "settings": library._Settings,
    "log": library._Log,
    "batch": library._Batch,
    "clouds": library._Clouds,
}


def printed(folder, lines: list[str], include=GENERATED) -> list[int]:
    """The integers that C expressions are worth."""
    compiler = c_compiler()
    headers = (
        "layout.h",
        "breathing_layout.h",
        "loops.h",
        "stationary.h",
        "sums.h",
        "exact.h",
        "exact_springs.h",
        "fixed.h",
        "pose.h",
        "eigenbasis.h",
    )
    top = [f'#include "{name}"' for name in headers]
    top += ["#include <stddef.h>", "#include <stdio.h>", "int main(void)", "{"]
    body = [f'    printf("%ld\\n", (long)({line}));' for line in lines]
    (folder / "program.c").write_text("\n".join([*top, *body, "    return 0;", "}", ""]), "utf-8")
    places = [f"-I{include}", f"-I{HERE}", f"-I{GENERATED}"]
    command = [*compiler, *places, str(folder / "program.c"), "-o", str(folder / "program")]
    subprocess.run(command, check=True)
    run = subprocess.run(
        [str(folder / "program")], capture_output=True, text=True, check=True, encoding="utf-8"
    )
    return [int(line) for line in run.stdout.split()]


def faults(folder, types, include=GENERATED) -> list[str]:
    """Parts of records that stand elsewhere in C than NumPy's types say."""
    names, expected = [], []
    for name, record in types.items():
        names.append(f"CERTREG_{name.upper()}")
        expected.append(width(record))
        for part, (_, offset, *_) in record.fields.items():
            names.append(f"CERTREG_{name.upper()}_{part.upper()}")
            expected.append(offset // 8)
    found = printed(folder, names, include)
    return [name for name, one, other in zip(names, expected, found, strict=True) if one != other]


@pytest.mark.slow
def test_every_part_of_every_record_stands_where_the_c_says(tmp_path):
    assert set(layout._TYPES) == set(RECORDS)
    assert faults(tmp_path, layout._TYPES) == []


@pytest.mark.slow
def test_a_part_in_another_place_is_seen(tmp_path):
    """Two parts of a body exchanged in one of both: the other no longer fits."""
    parts = dict(RECORDS["body"].parts)
    parts["damping"], parts["spread"] = parts.pop("damping"), parts.pop("spread")
    other = [
        RecordLayout(name="body", parts=parts) if r.name == "body" else r for r in emit.records()
    ]
    files, place = layout_files(other), tmp_path / "mutated"
    place.mkdir()
    for name, content in files.items():
        (place / name).write_bytes(content)
    moved = ["CERTREG_BODY_SPREAD", "CERTREG_BODY_DAMPING"]

    assert faults(tmp_path, layout._TYPES, include=place) == moved
    mutated = record_types(json.loads(files["layout.json"]))
    assert set(faults(tmp_path, mutated)) == set(moved)


def test_the_records_are_those_of_the_derivations():
    for name, parts in (
        ("matrix_state", motion.State().parts),
        ("quaternion_state", emit.QuaternionState().parts),
        ("body", motion.Body().parts),
        ("spring_body", spring_motion.SpringBody().parts),
    ):
        record = layout._TYPES[name]
        flat = motion.flat(parts)
        entries = named(np.arange(float(len(flat))), record)
        for part, value in parts.items():
            mine = [flat[int(k)] for k in np.ravel(entries[part])]
            assert mine == list(motion.flat({part: value})), (name, part)


@pytest.mark.slow
def test_structs_that_python_passes_are_those_of_the_headers(tmp_path):
    lines, expected = [], []
    for name, struct in STRUCTS.items():
        lines.append(f"sizeof(struct certreg_{name})")
        expected.append(ctypes.sizeof(struct))
        for field, *_ in struct._fields_:
            lines.append(f"offsetof(struct certreg_{name}, {field})")
            expected.append(getattr(struct, field).offset)
    points = floating_sums.CloudPoints
    for field, *_ in points._fields_:
        cloud, _, column = field.partition("_")
        member = f"{cloud}.{column}" if column else field
        lines.append(f"offsetof(struct certreg_points, {member})")
        expected.append(getattr(points, field).offset)

    assert printed(tmp_path, lines) == expected


@pytest.mark.slow
def test_numbers_that_c_and_python_share_are_equal(tmp_path):
    lines = [
        "CERTREG_FIXED_WORDS",
        "CERTREG_EXACT_WORDS",
        "CERTREG_FEW_WORDS",
        "CERTREG_SUMMED",
        "CERTREG_NOT_FINITE",
        "CERTREG_FIXED_SUMMED",
        "CERTREG_FIXED_NOT_FINITE",
        "CERTREG_SPRINGS",
        "CERTREG_SPRINGS_WORDS",
        "CERTREG_SCRATCH",
        "CERTREG_GO_ON",
        "CERTREG_CONVERGED",
        "CERTREG_AT_REST",
        "CERTREG_PERTURBED",
        "CERTREG_POSE",
        "CERTREG_POSE_ROTATION",
        "CERTREG_POSE_TRANSLATION",
        "CERTREG_POSE_MASS",
        "CERTREG_POSE_CROSS",
    ]

    assert printed(tmp_path, lines) == [
        eigenbasis.FIXED_WORDS,
        sums.EXACT_WORDS,
        sums.FEW_WORDS,
        *[sums.SUMMED, sums.NOT_FINITE] * 2,
        sums.SPRING_SUMS,
        sums.SPRING_WORDS,
        library.SCRATCH,
        *(
            int(end)
            for end in (
                Ending.OUT_OF_STEPS,
                Ending.CONVERGED,
                Ending.AT_REST,
                Ending.PERTURBED,
            )
        ),
        fast_pose.NUMBERS,
        fast_pose.ROTATION.start,
        fast_pose.TRANSLATION.start,
        fast_pose.DECIDING.start,
        fast_pose.CROSS.start,
    ]


@pytest.mark.parametrize("seed", range(3))
def test_generated_functions_read_and_write_the_parts_by_these_names(seed):
    """c' = v and v' = -2 c - mu v, R' = R [omega]; energies term by term."""
    rng = np.random.default_rng(seed)
    state, body = named(rng.normal(size=18), MATRIX_STATE), named(rng.normal(size=23), BODY)
    evaluate = current_engine().evaluate

    (rates,) = evaluate("certreg_rate", state, body)
    rate = named(rates, MATRIX_STATE)
    (numbers,) = evaluate("certreg_energies", state, body)
    energies = named(numbers, ENERGIES)

    c, R, v, omega = (state[part] for part in ("c", "R", "v", "omega"))
    assert np.array_equal(rate["c"], v)
    assert rate["v"] == pytest.approx(-2.0 * c - body["damping"] * v)
    assert rate["R"] == pytest.approx(R @ np.cross(omega, np.eye(3)).T)
    alignment = (R * body["cross"]).sum()
    assert energies["translation"] == pytest.approx(v @ v / 2.0)
    assert energies["rotation"] == pytest.approx(omega @ symmetric(body["inertia"]) @ omega / 2.0)
    assert energies["alignment"] == pytest.approx(alignment)
    assert energies["potential"] == pytest.approx(c @ c + body["spread"] - 2.0 * alignment)


@pytest.mark.parametrize("shape", [(), (1,)])
def test_one_record_of_a_list_is_that_of_an_array(shape):
    numbers = [0.1 * k for k in range(width(BODY))]
    record = record_of(numbers, BODY, shape)

    assert (record.shape, record.dtype, record.flags.writeable) == (shape, BODY, True)
    assert record.tobytes() == named(numbers, BODY).tobytes()
    for count in (0, len(numbers) - 1, len(numbers) + 1):
        with pytest.raises(ValueError, match=f"^{count} numbers: expected {len(numbers)}$"):
            record_of([1.0] * count, BODY, shape)


def test_records_and_doubles_are_two_views_of_one_memory():
    numbers = np.arange(26.0).reshape(2, 13)
    states = named(numbers, QUATERNION_STATE)
    states["q"][1] = 0.0

    assert not numbers[1, 3:7].any()
    assert np.shares_memory(plain(states), numbers)
    assert plain(states[:0]).shape == (0, 13)
    assert plain(states[::2]).tolist() == [numbers[0].tolist()]
    with pytest.raises(ValueError, match=r"numbers of shape \(2, 13\): expected \(\.\.\., 20\)"):
        named(numbers, BASIN)


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
