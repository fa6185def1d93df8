"""Every format of clouds is read to the bit, as its description says, or refused in one line."""

from __future__ import annotations

import io
import json
import re
import struct
import subprocess
import sys
import time
import zipfile
from itertools import product
from pathlib import Path
from typing import Any

import cloud_files as files
import numpy as np
import pytest
from cloud_files import archive, npy, npz, pcd, ply, xyz_ply
from commands import Run, certreg, write_csv
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.rates import broken_files
from certreg.errors import InvalidFileError
from certreg.io import scans as packed_scans
from certreg.io.clouds import parse_cloud, read_cloud
from certreg.io.labels import Match
from certreg.io.pairing import Pairing
from certreg.io.pcd import decompress
from certreg.io.problems import read_problem
from certreg.io.written_clouds import write_cloud

DOUBLES = st.floats(allow_nan=False, allow_infinity=False)
POINTS = [[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]
ARRAY = np.array(POINTS)
KINDS = ("ascii", "binary_little_endian", "binary_big_endian")
DATA = ("ascii", "binary", "binary_compressed")
F4 = [(axis, "F", 4, 1) for axis in "xyz"]


def read(content: bytes, suffix: str) -> tuple[list[list[float]], tuple[str, ...]]:
    """Points and what was left out; no disk is touched."""
    cloud = parse_cloud(io.BytesIO(content), Path(f"cloud{suffix}"))
    assert cloud.points.dtype == np.float64
    assert cloud.points.flags.c_contiguous
    assert cloud.labels is None
    return cloud.points.tolist(), cloud.ignored


def bits(points: Any) -> bytes:
    return np.array(points, dtype="<f8").reshape(-1, 3).tobytes()


def values(code: str) -> st.SearchStrategy[Any]:
    """Numbers that a type can hold, by its letter in `struct`."""
    if code in "fd":
        return st.floats(width=32 if code == "f" else 64, allow_nan=False, allow_infinity=False)
    size = struct.calcsize(f"<{code}")
    low, high = (-(1 << 8 * size - 1), (1 << 8 * size - 1) - 1) if code.islower() else (0, 0)
    high = high or (1 << 8 * size) - 1
    return st.integers(max(low, -(2**53)), min(high, 2**53))


# PLY ---------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize("code", sorted(set(files.PLY_CODES.values())))
def test_a_ply_file_of_any_type_and_order_is_read_bit_for_bit(code: str):
    value, names = values(code), [name for name, of in files.PLY_CODES.items() if of == code]

    @given(st.lists(st.tuples(value, value, value), min_size=1, max_size=4))
    def holds(points):
        for name, kind in product(names, KINDS):
            assert bits(read(xyz_ply(points, kind, name), ".ply")[0]) == bits(points)

    holds()


@st.composite
def meshes(draw) -> tuple[list[files.Element], list[list[float]]]:
    """Elements of any properties around and within the vertices, and the points."""
    types = st.sampled_from(sorted(files.PLY_CODES))
    counts = st.sampled_from(["uchar", "int8", "ushort", "int", "uint32"])

    def element(name: str, first: list[tuple[str, ...]], size: int) -> files.Element:
        more = draw(st.lists(st.tuples(types) | st.tuples(counts, types), max_size=3))
        least = [("uchar",)] if not first and not more else []
        others = [(*kinds, f"p{k}") for k, kinds in enumerate([*more, *least])]
        properties = draw(st.permutations([*first, *others]))
        same = draw(st.none() | st.integers(0, 3))  # lists of one length, or of any
        rows = [[_value(draw, types, same) for *types, _ in properties] for _ in range(size)]
        return name, list(properties), rows

    around = [element(name, [], draw(st.integers(0, 3))) for name in ("camera", "face", "edge")]
    axes = [(draw(types), axis) for axis in "xyz"]
    vertex = element("vertex", axes, draw(st.integers(1, 4)))
    places = [[p[-1] for p in vertex[1]].index(axis) for axis in "xyz"]
    points = [[float(row[place]) for place in places] for row in vertex[2]]
    return draw(st.permutations([*around, vertex])), points


def _value(draw, types: list[str], same: int | None) -> Any:
    value = values(files.PLY_CODES[types[-1]])
    if len(types) == 1:
        return draw(value)
    shape = (0, 3) if same is None else (same, same)
    return draw(st.lists(value, min_size=shape[0], max_size=shape[1]))


@pytest.mark.slow
@given(mesh=meshes(), kind=st.sampled_from(KINDS), newline=st.sampled_from(["\n", "\r\n"]))
def test_a_ply_file_with_anything_around_the_points_is_read_bit_for_bit(mesh, kind, newline):
    elements, points = mesh
    found, ignored = read(ply(elements, kind, newline), ".ply")

    assert bits(found) == bits(points)
    vertex = next(element for element in elements if element[0] == "vertex")
    others = {p[-1] for p in vertex[1]} - set("xyz") | {"camera", "face", "edge"}
    assert set(ignored) == others


@pytest.mark.slow
@given(mesh=meshes(), kind=st.sampled_from(KINDS[1:]), data=st.data())
def test_a_ply_file_cut_anywhere_or_continued_is_refused(mesh, kind, data):
    content = ply(mesh[0], kind)
    cut = data.draw(st.integers(0, len(content) - 1))

    for broken in (content[:cut], content + b"\0"):
        with pytest.raises(InvalidFileError, match=r"cloud\.ply"):
            read(broken, ".ply")


def test_a_written_ply_file_is_what_the_format_says(tmp_path: Path):
    points = np.array([[-0.0, 5e-324, 1.7976931348623157e308], [1, 2, 3]])
    write_cloud(tmp_path / "a.ply", points, ("a", "b"))
    head = b"ply\nformat binary_little_endian 1.0\nelement vertex 2\n"
    head += b"property double x\nproperty double y\nproperty double z\nend_header\n"

    assert (tmp_path / "a.ply").read_bytes() == head + struct.pack("<6d", *points.ravel())


def test_in_ascii_the_number_that_is_written_counts():
    content = xyz_ply([[0.1, 1, 2]], "ascii", "float")

    assert read(content, ".ply")[0] == [[0.1, 1, 2]]
    assert read(xyz_ply([[0.1, 1, 2]], KINDS[1], "float"), ".ply")[0][0][0] == float(
        np.float32(0.1)
    )


@pytest.mark.slow
def test_a_ply_file_of_437645_vertices_is_read_within_a_second(tmp_path: Path):
    points = np.random.default_rng(1).normal(size=(437_645, 3)).astype(">f4")
    head = b"ply\nformat binary_big_endian 1.0\nelement vertex 437645\n"
    head += b"property float x\nproperty float y\nproperty float z\nend_header\n"
    (tmp_path / "a.ply").write_bytes(head + points.tobytes())
    start = time.process_time()
    cloud = read_cloud(tmp_path / "a.ply")

    assert time.process_time() - start < 1
    assert np.array_equal(cloud.points, points)


# PCD ---------------------------------------------------------------------------------------------


@st.composite
def scans(draw) -> tuple[list[files.Field], list[files.Row], int]:
    """Fields of any types around x, y, z; rows; height."""
    kinds = st.sampled_from(sorted(files.PCD_CODES))
    fields = [(axis, *draw(kinds), 1) for axis in "xyz"]
    titles = ("rgb", "_", "_", "normal")
    fields += [(t, *draw(kinds), draw(st.integers(1, 3))) for t in titles if draw(st.booleans())]
    fields = draw(st.permutations(fields))
    codes = [files.PCD_CODES[letter, size] for _, letter, size, n in fields for _ in range(n)]
    height = draw(st.integers(1, 3))
    size = height * draw(st.integers(1, 3))
    rows = draw(st.lists(st.tuples(*map(values, codes)).map(list), min_size=size, max_size=size))
    return fields, rows, height


@pytest.mark.slow
@given(scan=scans(), data=st.sampled_from(DATA))
def test_a_pcd_file_of_any_fields_and_height_is_read_bit_for_bit(scan, data):
    fields, rows, height = scan
    names = [name for name, _, _, count in fields for _ in range(count)]
    places = [names.index(axis) for axis in "xyz"]
    found, ignored = read(pcd(fields, rows, data, height=height), ".pcd")

    assert bits(found) == bits([[float(row[place]) for place in places] for row in rows])
    assert set(ignored) == {name for name, *_ in fields} - {"x", "y", "z", "_"}


@pytest.mark.parametrize("data", DATA)
def test_a_pcd_file_may_leave_out_what_has_a_default(data: str):
    content = pcd(F4, POINTS, data, height=2, VERSION="", COUNT="", VIEWPOINT="")

    assert read(content, ".pcd") == (POINTS, ())


@pytest.mark.parametrize("data", DATA)
def test_fields_of_several_numbers_move_no_point_wherever_they_stand(data: str):
    x, y, z, more = *F4, ("normal", "F", 8, 3)
    for fields in ([more, x, y, z], [x, more, y, z], [z, y, more, x]):
        names = [name for name, _, _, count in fields for _ in range(count)]
        rows = [[float(k + step) for k in range(6)] for step in (1, 100, 1000)]
        points = [[row[names.index(axis)] for axis in "xyz"] for row in rows]

        assert read(pcd(fields, rows, data), ".pcd") == (points, ("normal",))


@pytest.mark.parametrize("data", DATA)
def test_a_missing_point_of_an_organised_cloud_is_named(data: str):
    content = pcd(F4, [*POINTS[:2], [1.0, float("nan"), 2.0], POINTS[3]], data, height=2)

    with pytest.raises(
        InvalidFileError,
        match=r"row 2 .*nan|line 14, y: 'nan' is not a number: remove",
    ):
        read(content, ".pcd")


@pytest.mark.slow
@given(st.binary(max_size=40).map(lambda part: part * 9 + bytes(300) + part))
def test_lzf_gives_back_what_was_packed(raw: bytes):
    packed = files.lzf(raw)

    assert len(packed) < 200 + len(raw) // 2
    assert decompress(packed, len(raw)) == raw
    assert decompress(packed, len(raw) + 1) is None
    assert decompress(packed, len(raw) - 1) is None
    assert decompress(packed[:-1], len(raw)) is None


def test_lzf_copies_only_what_is_there():
    assert decompress(bytes([1, 7, 8, 0x60, 1]), 7) == bytes([7, 8, 7, 8, 7, 8, 7])
    assert decompress(bytes([1, 7, 8, 0x60, 2]), 7) is None  # from before the beginning
    assert decompress(bytes([3, 7, 8]), 2) is None  # fewer new bytes than said
    assert decompress(bytes([0, 7, 0xE0]), 1) is None
    assert decompress(b"", 0) == b""


@pytest.mark.parametrize("suffix", [".ply", ".pcd", ".npy", ".npz"])
def test_a_binary_file_has_a_largest_size(monkeypatch, suffix: str):
    content = {".ply": PLY, ".pcd": PACKED, ".npy": npy(POINTS), ".npz": NPZ}[suffix]
    monkeypatch.setattr("certreg.io.streams.MAX_BINARY_BYTES", 20)
    with pytest.raises(InvalidFileError, match=r"[0-9]+ bytes are too many: is it a cloud\?"):
        read(content, suffix)


def test_compressed_points_have_a_largest_size(monkeypatch):
    monkeypatch.setattr("certreg.io.pcd.MAX_UNPACKED_BYTES", 47)
    with pytest.raises(InvalidFileError, match="corrupt or too large"):
        read(PACKED, ".pcd")


# NPZ ---------------------------------------------------------------------------------------------

WEIGHTS = [1.0, 2, 3, 4]
ARCHIVES: dict[str, tuple[bytes, tuple[str, ...]]] = {
    "one array": (npz({"arr_0": POINTS}), ()),
    "one array, packed": (npz({"arr_0": POINTS}, zipfile.ZIP_DEFLATED), ()),
    "one cloud among others": (npz({"w": WEIGHTS, "p": POINTS, "k": 3}), ("w", "k")),
    "points among clouds": (npz({"normals": np.ones((4, 3)), "points": POINTS}), ("normals",)),
    "float32": (npz({"points": ARRAY.astype(">f4")}), ()),
    "integers, by columns": (npz({"points": np.asfortranarray(ARRAY.astype("u2"))}), ()),
    "beside words and objects": (
        archive({"points.npy": npy(POINTS), "a.npy": npy(["a"]), "read.me": b"text"}),
        ("a", "read.me"),
    ),
    "a pickle that is left alone": (
        archive({"p.npy": npy(POINTS), "o.npy": npy(np.array([{}]), allow_pickle=True)}),
        ("o",),
    ),
}


@pytest.mark.parametrize("name", ARCHIVES)
def test_the_points_of_an_archive_are_found(name: str):
    content, ignored = ARCHIVES[name]

    assert read(content, ".npz") == (POINTS, ignored)


@pytest.mark.slow
@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
@given(points=st.lists(st.tuples(DOUBLES, DOUBLES, DOUBLES), min_size=1, max_size=5))
def test_what_numpy_saves_is_read_bit_for_bit(save, points):
    buffer = io.BytesIO()
    save(buffer, points=np.array(points))

    assert bits(read(buffer.getvalue(), ".npz")[0]) == bits(points)


def test_an_archive_that_unpacks_to_too_much_is_refused_before_it_is(monkeypatch):
    content = npz({"points": np.zeros((100_000, 3))}, zipfile.ZIP_DEFLATED)
    monkeypatch.setattr("certreg.io.npz.MAX_UNPACKED_BYTES", 2_000_000)
    with pytest.raises(InvalidFileError, match=r"2400128 bytes long, .* too large"):
        read(content, ".npz")


# XYZ ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "points", "ignored"),
    [
        ("1 2 3\n4 5 6\n", [[1, 2, 3], [4, 5, 6]], ()),
        ("# said\n1,2,3\n\n4,5,6", [[1, 2, 3], [4, 5, 6]], ()),
        ("1 2 3 9\n4 5 6 9\n", [[1, 2, 3], [4, 5, 6]], ("column 4",)),
        ("2\nwater, cut\nO 1 2 3\nH1 4 5 6\n", [[1, 2, 3], [4, 5, 6]], ()),
        (" 2 \r\n\r\nO 1 2 3\r\nH 4 5 6\r\n\r\n", [[1, 2, 3], [4, 5, 6]], ()),
        ("1\n# 5 6 7\nC 1e0 +2 .3e1 0.1 x", [[1, 2, 3]], ("column 5", "column 6")),
        ("\ufeff1\n3\nO\t1\t2\t3", [[1, 2, 3]], ()),
    ],
)
def test_an_xyz_file_is_plain_or_chemical(text: str, points, ignored):
    assert read(text.encode(), ".xyz") == (points, ignored)


@pytest.mark.slow
def test_xyz_clouds_are_verified_without_numpy(tmp_path: Path):
    rows = ["O 0 0 0", "H 1 0 0", "H 0 2 0", "C 0 0 3"]
    source, target = tmp_path / "a.xyz", tmp_path / "b.xyz"
    source.write_text("\n".join(["4", "by hand", *rows]), "utf-8")
    target.write_text("\n".join(row[2:] for row in rows), "utf-8")
    assert certreg("certify", source, target, "--out", tmp_path / "out").code == 0
    code = (
        "import sys\nfrom certreg.cli.main import main\n"
        "try:\n    main()\nexcept SystemExit as stop:\n"
        "    print(stop.code, 'numpy' in sys.modules)"
    )
    certificate = tmp_path / "out" / "certificate.json"
    for files_, word in (
        ((source, target), "False"),
        ((source, source, "--match", "all"), "False"),
    ):
        command = [sys.executable, "-c", code, "verify", certificate, *files_]
        done = subprocess.run(command, capture_output=True, text=True, check=True, encoding="utf-8")
        assert done.stdout.splitlines()[-2:] == ["VERIFIED", f"0 {word}"]


# Refused -----------------------------------------------------------------------------------------


def head(kind: str, *lines: str) -> bytes:
    return "\n".join(["ply", f"format {kind} 1.0", *lines, "end_header", ""]).encode()


XYZ = ("property double x", "property double y", "property double z")
PLY = xyz_ply(POINTS)
ASCII = xyz_ply(POINTS, "ascii")
FACES: list[files.Element] = [
    ("vertex", [("double", axis) for axis in "xyz"], POINTS),
    ("face", [("char", "int", "vertex_indices")], [[[0, 1, 2]], [[0, 1, 2, 3]]]),
]
PCD = pcd(F4, POINTS)
PACKED = pcd(F4, POINTS, "binary_compressed")
NPZ = npz({"points": POINTS})
RAW = ARRAY.astype("<f4").T.tobytes()
NAN = [[0.0, 0, 0], [float("nan"), 1, 2], [0, 1, 2], [1, 1, 1]]


def forged(content: bytes, size: int) -> bytes:
    """An archive whose members are all said to unpack to another size."""
    data = bytearray(content)
    for mark, place in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        at = data.find(mark)
        while at >= 0:
            data[at + place : at + place + 4] = struct.pack("<I", size)
            at = data.find(mark, at + 4)
    return bytes(data)


def bomb(size: int) -> bytes:
    """A short archive whose member declares a cloud of this many bytes, in all places alike."""
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({size // 24}, 3), }}"
    text = text.ljust(117) + "\n"
    top = b"\x93NUMPY\x01\0" + struct.pack("<H", len(text)) + text.encode()
    whole = archive({"points.npy": top + bytes(10_000)}, zipfile.ZIP_DEFLATED)
    return forged(whole, len(top) + size // 24 * 24)


def encrypted(content: bytes) -> bytes:
    data = bytearray(content)
    data[6] |= 1
    data[data.find(b"PK\x01\x02") + 8] |= 1
    return bytes(data)


REFUSED: dict[str, tuple[str, bytes, str]] = {
    "empty ply": ("ply", b"", "end_header"),
    "text as ply": ("ply", b"0 0 0\n1 2 3\n", "end_header"),
    "no magic": ("ply", PLY[4:], "begin with 'ply'"),
    "format later": ("ply", PLY.replace(b"format", b"comment"), "begin with 'ply' and 'format'"),
    "middle-endian": ("ply", PLY.replace(b"little", b"middle"), "line 2: unknown format"),
    "version 2": ("ply", PLY.replace(b"1.0\n", b"2.0\n"), "line 2: unknown format"),
    "cut header": ("ply", PLY[:60], "end_header"),
    "endless header": (
        "ply",
        PLY.replace(b"comment", b"comment\n" * 10_000 + b"comment"),
        "too long",
    ),
    "endless header line": ("ply", b"ply\nformat ascii 1.0\n" + b"c" * 100_000, "too long"),
    "unknown key": ("ply", PLY.replace(b"comment", b"remark"), "line 3: 'remark'"),
    "no vertices": ("ply", PLY.replace(b"vertex", b"corner"), "no vertices"),
    "no z": ("ply", head("ascii", "element vertex 1", *XYZ[:2]) + b"1 2\n", "no vertices"),
    "x as list": (
        "ply",
        ply([("vertex", [("uchar", "int", "x"), ("int", "y"), ("int", "z")], [[[1], 2, 3]])]),
        "no vertices",
    ),
    "vertices 0": ("ply", head("ascii", "element vertex 0", *XYZ), "no vertices"),
    "no vertices declared": ("ply", head("ascii"), "no vertices"),
    "negative count": ("ply", PLY.replace(b"vertex 4", b"vertex -4"), "line 4: '-4'"),
    "a huge count": ("ply", PLY.replace(b"vertex 4", b"vertex " + b"9" * 30), "line 4"),
    "a large count": ("ply", PLY.replace(b"vertex 4", b"vertex " + b"9" * 18), "row 4 "),
    "one more vertex": ("ply", PLY.replace(b"vertex 4", b"vertex 5"), "row 4 (counting from 0)"),
    "one less vertex": ("ply", PLY.replace(b"vertex 4", b"vertex 3"), "declares 72 bytes"),
    "truncated ply": ("ply", PLY[:-1], "row 3 (counting from 0)"),
    "a byte behind": ("ply", PLY + b"\n", "holds 97"),
    "unknown type": ("ply", PLY.replace(b"double y", b"int64 y"), "line 6: write 'property"),
    "x twice": ("ply", PLY.replace(b"double y", b"double x"), "line 6: write 'property"),
    "vertex twice": (
        "ply",
        head("ascii", "element vertex 1", *XYZ, "element vertex 1", *XYZ) + b"1 2 3\n" * 2,
        "line 7: write 'element",
    ),
    "property before element": ("ply", head("ascii", *XYZ), "line 3: 'property'"),
    "list of float length": (
        "ply",
        PLY.replace(b"double y", b"list float int y"),
        "line 6: write 'property",
    ),
    "list without type": ("ply", PLY.replace(b"double y", b"list y"), "line 6: write 'property"),
    "element without properties": (
        "ply",
        head("ascii", "element vertex 1", *XYZ, "element a 1") + b"1 2 3\n\n",
        "'a' has no properties",
    ),
    "NaN in ply": ("ply", xyz_ply(NAN), "row 1 (counting from 0)"),
    "infinity in ply": ("ply", xyz_ply([[1.0, 2, float("inf")]]), "row 0 "),
    "a list of negative length": (
        "ply",
        ply(FACES).replace(b"\x04\0\0\0\0", b"\xff\0\0\0\0"),
        "row 1 (counting from 0)",
    ),
    "a list beyond the end": ("ply", ply(FACES)[:-4], "row 1 (counting from 0)"),
    "a word in ply": ("ply", ASCII.replace(b"3\n", b"three\n"), "line 12, z: 'three'"),
    "a fraction for an integer": (
        "ply",
        ASCII.replace(b"double x", b"int x").replace(b"\n1 0 0", b"\n1.5 0 0"),
        "line 9, x: '0.0'",
    ),
    "too large for its type": (
        "ply",
        head("ascii", "element vertex 1", "property uchar x", *XYZ[1:]) + b"256 0 0\n",
        "line 8, x: '256'",
    ),
    "digits without end": (
        "ply",
        head("ascii", "element vertex 1", "property int x", *XYZ[1:]) + b"0" * 5000 + b"1 0 0\n",
        "line 8, x: '000",
    ),
    "a short ascii row": ("ply", ASCII.replace(b"0 2 0\n", b"0 2\n"), "line 11: 2 numbers"),
    "an ascii row too few": ("ply", ASCII.replace(b"vertex 4", b"vertex 5"), "row 4 "),
    "an ascii row too many": ("ply", ASCII + b"1 2 3\n", "line 13: more rows"),
    "an ascii list too short": (
        "ply",
        ply(FACES, "ascii").replace(b"4 0 1 2 3", b"5 0 1 2 3"),
        "line 16: 5 numbers",
    ),
    "binary said to be ascii": ("ply", PLY.replace(KINDS[1].encode(), b"ascii"), "line 9"),
    # pcd
    "empty pcd": ("pcd", b"", "'DATA'"),
    "ply as pcd": ("pcd", PLY, "'DATA'"),
    "no fields": ("pcd", pcd(F4, POINTS, FIELDS=""), "no FIELDS"),
    "no points entry": ("pcd", pcd(F4, POINTS, POINTS=""), "no POINTS"),
    "fields of other names": ("pcd", pcd(F4, POINTS, FIELDS="x y w"), "line 3: give one field"),
    "x twice in pcd": ("pcd", pcd(F4, POINTS, FIELDS="x x z"), "line 3: give one field"),
    "too few sizes": ("pcd", pcd(F4, POINTS, SIZE="4 4"), "line 4: 2 entries for 3 fields"),
    "too many types": ("pcd", pcd(F4, POINTS, TYPE="F F F F"), "line 5: 4 entries"),
    "too few counts": ("pcd", pcd(F4, POINTS, COUNT="1"), "line 6: 1 entries"),
    "floats of two bytes": ("pcd", pcd(F4, POINTS, SIZE="4 4 2"), "line 5: field 'z'"),
    "a type of letter C": ("pcd", pcd(F4, POINTS, TYPE="F F C"), "line 5: field 'z'"),
    "a vector as x": ("pcd", pcd(F4, POINTS, COUNT="2 1 1"), "of COUNT 1"),
    "count 0": ("pcd", pcd(F4, POINTS, COUNT="1 1 0"), "COUNT 0"),
    "width times height": ("pcd", pcd(F4, POINTS, WIDTH="3"), "width 3 times height 1"),
    "no points at all": ("pcd", pcd(F4, [], WIDTH="0"), "0 points"),
    "a wordy width": ("pcd", pcd(F4, POINTS, WIDTH="four"), "line 7: 'four'"),
    "a huge cloud": (
        "pcd",
        pcd(F4, POINTS, WIDTH="9" * 18, POINTS="9" * 18),
        f"declares {12 * (10**18 - 1)} bytes",
    ),
    "one more point": ("pcd", pcd(F4, POINTS, WIDTH="5", POINTS="5"), "declares 60 bytes"),
    "truncated pcd": ("pcd", PCD[:-1], "the file holds 47"),
    "a byte behind pcd": ("pcd", PCD + b"\0", "the file holds 49"),
    "a row more than pcd declares": (
        "pcd",
        pcd(F4, POINTS[:2], "ascii") + b"7 8 9\n",
        "line 14: row 3, the header declares 2 rows: ",
    ),
    "a number more than pcd declares": (
        "pcd",
        pcd(F4, POINTS[:2], "ascii")[:-1] + b" 9\n",
        "line 13: 4 numbers, the header declares 3: ",
    ),
    "unknown data": ("pcd", pcd(F4, POINTS, DATA="binary_zipped"), "line 11: unknown data"),
    "unknown entry": ("pcd", b"COLOUR 1\n" + PCD, "line 1: 'COLOUR'"),
    "an entry again": ("pcd", b"WIDTH 4\n" + PCD, "line 8: 'WIDTH'"),
    "unknown version": ("pcd", pcd(F4, POINTS, VERSION="1.0"), "line 2: unknown version"),
    "a short viewpoint": ("pcd", pcd(F4, POINTS, VIEWPOINT="0 0 0"), "line 9: the viewpoint"),
    "NaN in pcd": ("pcd", pcd(F4, NAN), "row 1 (counting from 0) is [nan, 1.0, 2.0]"),
    "NaN in ascii pcd": ("pcd", pcd(F4, NAN, "ascii"), "line 13, x: 'nan' is not a number: remove"),
    "integers beyond 2^53": (
        "pcd",
        pcd([(a, "I", 8, 1) for a in "xyz"], [[1, 2, 3], [1, 2, 2**53 + 1]]),
        "row 1 (counting from 0) is [1, 2, 9007199254740993]",
    ),
    "written integers beyond 2^53": (
        "pcd",
        pcd([(a, "I", 8, 1) for a in "xyz"], [[1, 2, 2**53 + 1]], "ascii"),
        "line 12, z: '9007199254740993'",
    ),
    "a short pcd row": ("pcd", pcd(F4, POINTS, "ascii")[:-5] + b"\n", "line 15: 1 numbers"),
    "a pcd row too many": ("pcd", pcd(F4, POINTS, "ascii") + b"1 2 3\n", "line 16"),
    "a pcd row too few": (
        "pcd",
        pcd(F4, POINTS, "ascii", WIDTH="5", POINTS="5"),
        "declares 5 points, the file holds 4",
    ),
    "packed to nothing": ("pcd", PACKED[: PACKED.index(b"compressed\n") + 14], "the file holds 3"),
    "packed size wrong": ("pcd", PACKED + b"\0", "the file holds"),
    "unpacked size wrong": (
        "pcd",
        PACKED.replace(struct.pack("<I", 48), struct.pack("<I", 49)),
        "the file holds 49",
    ),
    "packed data broken": (
        "pcd",
        PACKED[: -len(files.lzf(RAW))] + b"\xff" + files.lzf(RAW)[1:],
        "compressed data are corrupt",
    ),
    "packed bomb": (
        "pcd",
        pcd(F4, [], "binary_compressed", WIDTH="200000000", POINTS="200000000")[:-8]
        + struct.pack("<2I", 0, 2_400_000_000),
        "corrupt or too large",
    ),
    # npz
    "empty npz": ("npz", b"", "is not an .npz file"),
    "npy of a plane": (
        "npy",
        npy(ARRAY[:3, :2]),
        "N >= 1; of points in the plane give np.pad(array",
    ),
    "transposed npy": ("npy", npy(ARRAY.T), "expected (N, 3) with N >= 1; transpose it: array.T"),
    "homogeneous npy": (
        "npy",
        npy(np.ones((5, 4))),
        "; of homogeneous coordinates give array[:, :3] / array[:, 3:]",
    ),
    "npy as npz": ("npz", npy(POINTS), "is not an .npz file"),
    "no arrays": ("npz", archive({}), "holds nothing"),
    "two clouds": ("npz", npz({"a": POINTS, "b": POINTS}), "a (4, 3), b (4, 3)"),
    "points twice": (
        "npz",
        npz({"points": POINTS, "pointz": POINTS}).replace(b"tz", b"ts"),
        "points (4, 3), points",
    ),
    "no cloud": ("npz", npz({"w": WEIGHTS}), "w (4,)"),
    "points of another shape": ("npz", npz({"points": ARRAY.T, "a": POINTS}), "points (3, 4)"),
    "no rows": ("npz", npz({"points": ARRAY[:0]}), "points (0, 3)"),
    "complex points": ("npz", npz({"points": ARRAY + 0j}), "no real numbers"),
    "a pickle": (
        "npz",
        archive({"points.npy": npy(ARRAY.astype(object), allow_pickle=True)}),
        "no real numbers",
    ),
    "NaN in npz": ("npz", npz({"points": NAN}), "row 1 (counting from 0)"),
    "truncated npz": ("npz", NPZ[:-1], "truncated"),
    "npz cut in the middle": ("npz", NPZ[:150], "truncated"),
    "a byte behind npz": ("npz", NPZ + b"\0", "truncated"),
    "a byte before npz": ("npz", b"\0" + NPZ, "truncated"),
    "a comment behind npz": ("npz", NPZ[:-2] + b"\x01\0!", "truncated"),
    "a wrong checksum": ("npz", NPZ.replace(struct.pack("<d", 3), struct.pack("<d", 4)), "CRC"),
    "truncated npy within": ("npz", archive({"points.npy": npy(POINTS)[:-1]}), "223 bytes long"),
    "npy within continued": ("npz", archive({"points.npy": npy(POINTS) + b"\0"}), "225 bytes"),
    "sizes that disagree": ("npz", forged(NPZ, 10**6), "1000000 bytes long"),
    "a zip bomb": ("npz", bomb(2_000_000_000), "too large"),
    "a bomb that is none": (
        "npz",
        bomb(1_000_000),
        "declares 999984 bytes of data, the file holds 10000",
    ),
    "encrypted": ("npz", encrypted(NPZ), "encrypted"),
    "another packing": ("npz", npz({"points": POINTS}, zipfile.ZIP_LZMA), "packed in a way"),
    "too many arrays": ("npz", npz({f"a{k}": [1.0] for k in range(65)}), "too many arrays"),
    # xyz
    "empty xyz": ("xyz", b"", "three columns"),
    "a count too large": ("xyz", b"3\n\nO 1 2 3\nO 1 2 3\n", "declares 3 points, the file holds 2"),
    "a count too small": ("xyz", b"1\n\nO 1 2 3\nO 1 2 3\n", "line 4: more than the 1 points"),
    "a count of 0": ("xyz", b"0\n\n", "declares 0 points"),
    "a count alone": ("xyz", b"3", "declares 3 points"),
    "two frames": ("xyz", b"1\n\nO 1 2 3\n1\n\nO 1 2 3\n", "line 4: more than"),
    "no symbols": ("xyz", b"2\n\n1 2 3\n1 2 3\n", "line 3: not 'symbol x y z'"),
    "a number for a symbol": ("xyz", b"2\n\n1 2 3 4\n1 2 3 4\n", "line 3: not 'symbol x y z'"),
    "a short chemical row": ("xyz", b"2\n\nO 1 2 3\nO 1 2\n", "line 4: not 'symbol x y z'"),
    "NaN in xyz": ("xyz", b"1\n\nO 1 nan 3\n", "line 3: 'nan'"),
    "latin-1 in xyz": ("xyz", b"1\n\xc5\nO 1 2 3\n", "line 2: 'utf-8'"),
    "symbols without a count": ("xyz", b"O 1 2 3\n", "line 1: 'O'"),
}


@pytest.mark.one_in(3)
@pytest.mark.parametrize("name", REFUSED)
def test_a_broken_file_is_refused_in_one_line(tmp_path: Path, name: str):
    suffix, content, words = REFUSED[name]
    source, target = tmp_path / f"broken.{suffix}", write_csv(tmp_path / "good.csv", POINTS)
    source.write_bytes(content)
    for clouds in ((source, target), (target, source)):
        run = certreg("equilibria", *clouds)

        assert (run.code, run.out) == (2, "")
        assert re.fullmatch(r"certreg: [^\n]{10,500}\n", run.err), run.err
        assert run.err.strip().isprintable()
        assert str(source) in run.err
        assert words in run.err


def test_the_list_of_broken_files_is_long_and_its_good_files_are_good():
    assert len(REFUSED) >= 40
    for suffix, content in (
        (".ply", PLY),
        (".ply", ASCII),
        (".ply", ply(FACES)),
        (".ply", ply(FACES, "ascii")),
        (".pcd", PCD),
        (".pcd", PACKED),
        (".npz", NPZ),
    ):
        assert read(content, suffix)[0] == POINTS


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize(
    ("number", "seed"), [(700, 2), pytest.param(2300, 3, marks=pytest.mark.long)]
)
@pytest.mark.parametrize("name", broken_files.READERS)
def test_mutated_files_are_refused_cleanly_or_read_as_finite_numbers(
    name: str, number: int, seed: int
):
    start = broken_files.peak_memory()
    count = broken_files.fuzz(name, number, seed=seed)

    assert 0 < count.accepted < count.inputs == number
    assert broken_files.peak_memory() - start < broken_files.MEMORY


# Which row pairs with which ----------------------------------------------------------------------

LABELS = ("a", "b", "c", "d")
BENT = np.array([[0, 0, 0], [1, 0, 0], [0, 2.5, 0], [0, 0, 3], [1, 1, 1], [2, 0, 1.0]])
SHIFT = np.array([1, 2, 3])
TURNED = BENT @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]) + SHIFT
NOISE = [0.01, -0.02, 0.015, 0.0, 0.02, -0.01]


def pose(run: Run) -> Any:
    assert run.code == 0, run.err
    return run.document


@pytest.fixture
def clouds(tmp_path: Path) -> tuple[Path, Path, list[int]]:
    """Clouds without labels, the target's rows in another order: row i is row order[i]."""
    order = [3, 0, 5, 1, 4, 2]
    target = np.empty_like(TURNED)
    target[order] = TURNED + np.array(NOISE)[:, None]
    np.save(tmp_path / "b.npy", target)
    return write_csv(tmp_path / "a.csv", BENT.tolist()), tmp_path / "b.npy", order


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        ([(0, 1), (1, 2), (0, 3)], "pair 2 (counting from 0) names row 0 of the source again"),
        ([(0, 1), (1, 2), (2, 1)], "row 1 of the target again"),
        ([(0, 1), (0, 1)], "row 0 of the source again"),
    ],
)
def test_pairs_that_repeat_rows_are_noted_or_refused_if_asked(tmp_path, clouds, pairs, words):
    np.savetxt(tmp_path / "p.txt", pairs)  # doubles in full, as Open3D's set is often saved
    told = (*clouds[:2], "--pairs", tmp_path / "p.txt")
    refused = certreg("equilibria", *told, "--one-to-one")

    assert (refused.code, refused.out) == (2, "")
    assert words in refused.err
    assert "p.txt: not one to one: " in certreg("equilibria", *told).err


def test_one_to_one_is_about_pairs_and_says_nothing_where_they_are_so(tmp_path: Path, clouds):
    source, target, order = clouds
    np.save(tmp_path / "p.npy", np.array(list(enumerate(order))))
    usage = certreg("equilibria", source, target, "--one-to-one")
    good = certreg("equilibria", source, target, "--pairs", tmp_path / "p.npy", "--one-to-one")

    assert (usage.code, "goes with --pairs" in usage.err) == (2, True)
    assert (good.code, good.err) == (0, "")


@pytest.mark.slow
def test_a_set_of_nearest_neighbours_is_certified_and_assessed_as_its_rows(tmp_path, clouds):
    """Many to one: as the same points written out."""
    pairs = np.array([(0, 0), (1, 0), (2, 3), (3, 4), (4, 4), (5, 2)], dtype=np.int32)
    np.save(tmp_path / "p.npy", pairs)
    told = (*clouds[:2], "--pairs", tmp_path / "p.npy")
    run = certreg("certify", *told, "--json", "--out", tmp_path / "out", "--no-relaxation")
    x, y = (read_cloud(file).points[rows] for file, rows in zip(clouds, pairs.T, strict=False))
    from certreg import RegistrationProblem

    assert run.code == 0
    assert "1 rows of the source" not in run.err
    assert "0 rows of the source and 2 of the target are in several pairs" in run.err
    assert f"6 pairs; left out: 0 of {clouds[0]}, 2 of {clouds[1]}" in run.err
    assert pose(run)["digest"] == RegistrationProblem(x, y).digest()
    assert certreg("verify", tmp_path / "out" / "certificate.json", *told).code == 0
    assert certreg("assess", *told, "--pose", tmp_path / "out" / "pose.txt").code == 0


def expected(rows: list[int], weights: list[float] | None = None) -> str:
    """The digest of the problem of these rows of the source."""
    numbers = None if weights is None else [weights[row] for row in rows]
    from certreg import RegistrationProblem

    target = TURNED + np.array(NOISE)[:, None]
    return RegistrationProblem(BENT[rows], target[rows], weights=numbers).digest()


PAIR_FILES = {
    "csv": ("p.csv", lambda pairs: "".join(f"{i},{j}\n" for i, j in pairs).encode()),
    "csv with header": (
        "p.csv",
        lambda pairs: b"source,target\r\n" + b"".join(b"%d,%d\r\n" % pair for pair in pairs),
    ),
    "txt": ("p.txt", lambda pairs: b"# by hand\n" + b"".join(b"%d %d\n" % p for p in pairs)),
    "npy": ("p.npy", lambda pairs: npy(np.array(pairs))),
    "small npy": ("p.npy", lambda pairs: npy(np.array(pairs, dtype=">u2"))),
}


@pytest.mark.one_in(3)
@pytest.mark.parametrize("kind", PAIR_FILES)
def test_pairs_tell_which_row_is_which(tmp_path: Path, clouds, kind: str):
    source, target, order = clouds
    rows = [4, 0, 3, 1, 2]
    name, encode = PAIR_FILES[kind]
    (tmp_path / name).write_bytes(encode([(row, order[row]) for row in rows]))
    weights = [1.0, 2, 3, 4, 5, 6]
    (tmp_path / "w.txt").write_text("\n".join(map(repr, weights)), "utf-8")
    told = ("--pairs", tmp_path / name)
    options = (*told, "--weights", tmp_path / "w.txt")
    run = certreg("certify", source, target, *options, "--json", "--out", tmp_path / "out")
    certificate = tmp_path / "out" / "certificate.json"

    assert pose(run)["digest"] == expected(rows, weights)
    assert f"5 pairs; left out: 1 of {source}, 1 of {target}" in run.err
    assert certreg("verify", certificate, source, target, *options).code == 0
    assert "give --weights FILE" in certreg("verify", certificate, source, target, *told).out
    assert certreg("verify", certificate, source, target, *options[2:]).code == 1
    assert certreg("verify", certificate, source, target).code == 1
    (tmp_path / name).write_bytes(encode([(row, order[row]) for row in sorted(rows)]))
    refused = certreg("verify", certificate, source, target, *options)
    assert (refused.code, refused.out[:8]) == (1, "REFUSED:")


@pytest.mark.slow
def test_every_command_on_clouds_takes_pairs(tmp_path: Path, clouds):
    source, target, order = clouds
    (tmp_path / "p.csv").write_text("".join(f"{i},{j}\n" for i, j in enumerate(order)), "utf-8")
    told = ("--pairs", tmp_path / "p.csv")
    found = pose(certreg("certify", source, target, *told, "--json"))
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = found["pose"]["rotation"], found["pose"]["translation"]
    np.savetxt(tmp_path / "pose.txt", matrix, fmt="%.17g")
    judge = ("--pose", tmp_path / "pose.txt")

    assert certreg("assess", source, target, *told, *judge).code == 0
    assert certreg("assess", source, target, *judge).code == 1
    rmse = [
        pose(certreg("equilibria", source, target, *options, "--json"))["equilibria"]["components"][
            0
        ]["rmse"]
        for options in (told, ())
    ]
    assert rmse[0] < 0.1 < rmse[1]


BAD_PAIRS: dict[str, tuple[str, bytes, str]] = {
    "missing": ("none.csv", b"", "cannot be read"),
    "empty": ("p.csv", b"", "no pairs"),
    "header only": ("p.csv", b"source,target\n", "no pairs"),
    "the header of another": ("p.csv", b"a,b\n0,0\n", "line 1: 'a'"),
    "header the other way round": ("p.csv", b"target,source\n0,0\n", "line 1: 'target'"),
    "one column": ("p.csv", b"0\n1\n", "line 1: 1 column: "),
    "three columns": ("p.csv", b"0,1\n1,2,3\n", "line 2: 3 columns"),
    "negative": ("p.csv", b"0,-1\n", "line 1: '-1' is not a count"),
    "fractions": ("p.txt", b"0 1.0\n", "line 1: '1.0' is not a count"),
    "underscores": ("p.txt", b"1_0 1\n", "'1_0' is not a count"),
    "huge": ("p.csv", b"0," + b"9" * 30, "is not a count"),
    "source out of range": (
        "p.csv",
        b"0,1\n6,0\n",
        "pair 1 (counting from 0) names row 6 of the s",
    ),
    "target out of range": ("p.csv", b"0,6\n", "row 6 of the target: its rows are 0 to 5"),
    "npy of doubles": ("p.npy", npy([[0.0, 1.0]]), "save row numbers as integers"),
    "npy of three columns": ("p.npy", npy([[0, 1, 2]]), "shape (1, 3)"),
    "negative npy": ("p.npy", npy([[0, -1]]), "row -1 of the target"),
    "npy beyond int64": ("p.npy", npy(np.array([[0, 2**63]], dtype="u8")), "row numbers"),
    "truncated npy": ("p.npy", npy([[0, 1]])[:-1], "declares 16"),
    "another format": ("p.ply", PLY, ".csv, .txt or .npy"),
}


@pytest.mark.parametrize("name", BAD_PAIRS)
def test_pairs_that_are_none_are_refused_in_one_line(tmp_path: Path, clouds, name: str):
    source, target, _ = clouds
    title, content, words = BAD_PAIRS[name]
    if title != "none.csv":
        (tmp_path / title).write_bytes(content)
    run = certreg("equilibria", source, target, "--pairs", tmp_path / title)

    assert (run.code, run.out) == (2, "")
    assert re.fullmatch(r"certreg: [^\n]{10,500}\n", run.err), run.err
    assert title in run.err
    assert words in run.err


@pytest.fixture
def labelled(tmp_path: Path) -> tuple[Path, Path]:
    """Five labels in common; each cloud has one of its own, and one that is there twice."""
    target = TURNED + np.array(NOISE)[:, None]
    extra = [[9.0, 9, 9], [8, 8, 8], [7, 7, 7]]
    here = [*BENT[:5].tolist(), *extra]
    there = [*extra, *target[4::-1].tolist()]
    first, second = [*"abcde", "u", "v", "v"], ["u2", "w", "w", *"edcba"]
    return (
        write_csv(tmp_path / "a.csv", here, first),
        write_csv(tmp_path / "b.csv", there, second),
    )


def test_match_common_keeps_the_labels_of_both_in_the_order_of_the_source(tmp_path: Path, labelled):
    weights = [1.0, 2, 3, 4, 5, 0, 0, 0]
    (tmp_path / "w.csv").write_text("\n".join(map(repr, weights)), "utf-8")
    options = ("--match", "common", "--weights", tmp_path / "w.csv")
    run = certreg("certify", *labelled, *options, "--json", "--out", tmp_path / "out")
    certificate = tmp_path / "out" / "certificate.json"

    assert pose(run)["digest"] == expected([0, 1, 2, 3, 4], weights)
    assert run.err == (f"note: 5 pairs; left out: 3 of {labelled[0]}, 3 of {labelled[1]}\n")
    accepted = certreg("verify", certificate, *labelled, *options)
    assert (accepted.code, accepted.err) == (0, run.err)
    assert "give --weights FILE" in certreg("verify", certificate, *labelled, *options[:2]).out
    for bad in (("--match", "all"), ()):
        refused = certreg("verify", certificate, *labelled, *bad)
        assert (refused.code, refused.out) == (2, "")
        assert "'u' occurs 0 times in the target" in refused.err
    pair = read_problem(*labelled, pairing=Pairing(match=Match.COMMON))[1]
    assert pair.source.labels == pair.target.labels == tuple("abcde")


def test_all_labels_in_common_leave_nothing_to_say(tmp_path: Path):
    cloud = write_csv(tmp_path / "a.csv", POINTS, LABELS)

    assert certreg("equilibria", cloud, cloud, "--match", "common").err == ""
    assert certreg("equilibria", cloud, cloud, "--match", "all").err == ""


def test_labels_that_cannot_be_matched_are_refused_in_one_line(tmp_path: Path):
    cloud = write_csv(tmp_path / "a.csv", POINTS, LABELS)
    bare = write_csv(tmp_path / "bare.csv", POINTS)
    other = write_csv(tmp_path / "other.csv", POINTS, "efgh")
    twice = write_csv(tmp_path / "twice.csv", POINTS, "abbd")
    for clouds, words in (
        ((cloud, bare), f"{bare}: has no labels"),
        ((bare, cloud), f"{bare}: has no labels"),
        ((cloud, other), "no label in common"),
        ((cloud, twice), "'b' occurs 2 times in the target"),
        ((twice, cloud), "'b' occurs 2 times in the source"),
    ):
        run = certreg("equilibria", *clouds, "--match", "common")
        assert (run.code, run.out) == (2, "")
        assert re.fullmatch(r"certreg: [^\n]{10,500}\n", run.err), run.err
        assert words in run.err


def test_pairs_win_over_labels_and_exclude_match_common(tmp_path: Path):
    cloud = write_csv(tmp_path / "a.csv", POINTS, LABELS)
    turned = write_csv(tmp_path / "b.csv", POINTS[::-1], LABELS)
    (tmp_path / "p.csv").write_text("0,3\n1,2\n2,1\n3,0\n", "utf-8")
    told = ("--pairs", tmp_path / "p.csv")
    run = certreg("equilibria", cloud, turned, *told, "--json")

    assert pose(run)["equilibria"]["components"][0]["rmse"] == pytest.approx(0, abs=1e-12)
    for command in (("equilibria",), ("verify", tmp_path / "c.json")):
        both = certreg(*command, cloud, turned, *told, "--match", "common")
        assert (both.code, both.out) == (2, "")
        assert "exclude each other" in both.err
    alone = certreg("verify", tmp_path / "c.json", *told)
    assert (alone.code, alone.out) == (2, "")
    assert "give SOURCE and TARGET" in alone.err


def test_weights_are_counted_by_the_rows_of_the_file(tmp_path: Path, labelled):
    (tmp_path / "w.csv").write_text("1\n1\n1\n1\n1\n", "utf-8")
    options = ("--match", "common", "--weights", tmp_path / "w.csv")
    run = certreg("equilibria", *labelled, *options)

    assert run.code == 2
    assert "holds 5 weights" in run.err
    assert "has 8 points" in run.err


# Through the commands ----------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("suffix", ["ply", "pcd", "npz", "xyz", "npy"])
def test_every_format_states_the_same_problem(tmp_path: Path, suffix: str):
    content = {
        "ply": xyz_ply(BENT.tolist(), KINDS[2]),
        "pcd": pcd([(a, "F", 8, 1) for a in "xyz"], BENT.tolist(), DATA[2], height=2),
        "npz": npz({"points": BENT}),
        "npy": npy(BENT),
        "xyz": ("6\n\n" + "".join(f"C {x!r} {y!r} {z!r}\n" for x, y, z in BENT.tolist())).encode(),
    }[suffix]
    target = write_csv(tmp_path / "b.csv", TURNED.tolist())
    (tmp_path / f"a.{suffix}").write_bytes(content)
    clouds = (tmp_path / f"a.{suffix}", target)
    run = certreg("certify", *clouds, "--json", "--out", tmp_path / "out")
    plain = certreg("certify", write_csv(tmp_path / "a.csv", BENT.tolist()), target, "--json")

    assert pose(run)["digest"] == pose(plain)["digest"]
    assert certreg("verify", tmp_path / "out" / "certificate.json", *clouds).code == 0
    assert (
        json.loads((tmp_path / "out" / "certificate.json").read_text("utf-8"))["problem"]["n"] == 6
    )


def test_a_cloud_is_moved_into_a_ply_file(tmp_path: Path):
    cloud = write_csv(tmp_path / "a.csv", POINTS)
    (tmp_path / "pose.txt").write_text("1 0 0 0 1 2 3\n", "utf-8")
    run = certreg("apply", tmp_path / "pose.txt", cloud, "--out", tmp_path / "b.ply")

    assert run.code == 0
    assert read_cloud(tmp_path / "b.ply").points.tolist() == (ARRAY + SHIFT).tolist()


@pytest.mark.parametrize(
    ("first", "second", "models"),
    [("1234", "1235", 2), ("1234", "2234", 2), ("   1", "   2", 2), ("1234a", "1234b", 1)],
)
def test_the_number_of_a_pdb_model_is_that_of_columns_11_to_14(
    first: str, second: str, models: int
):
    atom = "ATOM      1  CA  ALA A{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           C"
    lines = [
        *(f"MODEL     {first}", atom.format(1, 1.0, 2.0, 3.0), "ENDMDL"),
        *(f"MODEL     {second}", atom.format(2, 4.0, 5.0, 6.0), "ENDMDL", "END", ""),
    ]
    cloud = parse_cloud(io.BytesIO("\n".join(lines).encode()), Path("a.pdb"))

    assert cloud.points.tolist() == [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]][: 3 - models]
    assert ("the first of 2 models" in " ".join(cloud.notes)) == (models == 2)


PDB_ROW = "ATOM      1  CA {}LEU A   1    {:8.3f}   0.000   0.000{:>6}  0.00           C"
CIF_ROW = "ATOM CA C {} A 1 {} 0.0 0.0 {}"
CIF_TAGS = (
    "group_PDB label_atom_id type_symbol label_alt_id auth_asym_id auth_seq_id "
    "Cartn_x Cartn_y Cartn_z occupancy"
)


def places_of_an_atom(suffix: str, occupancies: list[str]) -> bytes:
    """A file of one Cα atom in places x = 0, 1, 2, ...; without an occupancy it is 1."""
    row, none = (PDB_ROW, "") if suffix == ".pdb" else (CIF_ROW, ".")
    places = enumerate(zip("ABCD", occupancies, strict=False))
    rows = [row.format(name, float(k), held or none) for k, (name, held) in places]
    if suffix == ".pdb":
        return "\n".join([*rows, "END", ""]).encode()
    tags = [f"_atom_site.{tag}" for tag in CIF_TAGS.split()]
    return "\n".join(["data_a", "loop_", *tags, *rows, ""]).encode()


@pytest.mark.parametrize("suffix", [".pdb", ".cif"])
@pytest.mark.parametrize(
    "occupancies",
    [["0.50"] * 2, ["0.25"] * 4, ["0.20", "0.40", "0.40"], ["", "1.00"], ["0.90", ""], ["0.00"]],
    ids=" ".join,
)
def test_of_equally_occupied_places_of_an_atom_the_first_is_taken(
    suffix: str, occupancies: list[str]
):
    if suffix == ".cif":
        pytest.importorskip("gemmi")
    content = places_of_an_atom(suffix, occupancies)
    cloud = parse_cloud(io.BytesIO(content), Path(f"a{suffix}"))
    held = [float(text or 1) for text in occupancies]

    assert cloud.points.tolist() == [[held.index(max(held)), 0.0, 0.0]]
    assert ("of 1 with alternative places" in " ".join(cloud.notes)) == (len(held) > 1)


@pytest.mark.parametrize("suffix", [".pdb", ".cif"])
@pytest.mark.parametrize("again", ["A", "B", "C"])
def test_a_place_of_an_atom_that_comes_again_is_refused_however_occupied(suffix: str, again: str):
    if suffix == ".cif":
        pytest.importorskip("gemmi")
    once = places_of_an_atom(suffix, ["0.50", "0.30", "0.20"])
    twice = places_of_an_atom(suffix, ["0.50", "0.30", "0.20", "0.10"])
    before = b"CA DLEU" if suffix == ".pdb" else b"CA C D A"
    assert parse_cloud(io.BytesIO(once), Path(f"a{suffix}")).points.tolist() == [[0.0] * 3]
    content = twice.replace(before, before.replace(b"D", again.encode()))
    with pytest.raises(InvalidFileError, match="atom A:1:CA comes again"):
        parse_cloud(io.BytesIO(content), Path(f"a{suffix}"))


@pytest.mark.parametrize("count", [1, 2, 5])
def test_rows_beyond_the_declared_number_of_an_xyz_file_are_refused_at_the_first(count: int):
    rows = "".join(f"C {k} 0 0\n" for k in range(count + 1))
    with pytest.raises(InvalidFileError, match=f"more than the {count} points of line 1") as caught:
        parse_cloud(io.BytesIO(f"{count}\n\n{rows}".encode()), Path("a.xyz"))

    assert (caught.value.line, caught.value.limit) == (count + 3, count)


@pytest.mark.parametrize("name", ["sigma", "weight"])
def test_a_column_of_noise_that_is_not_read_is_named_as_it_is_called(name: str):
    properties = [("double", axis) for axis in ("x", "y", "z", name)]
    content = ply([("vertex", properties, [[*point, 2.0] for point in POINTS])])
    noisy, plain = (
        parse_cloud(io.BytesIO(content), Path("a.ply"), noise=noise) for noise in (True, False)
    )

    given = {"sigma": noisy.sigma, "weight": noisy.weights}
    assert [key for key, values in given.items() if values is not None] == [name]
    assert (plain.sigma, plain.weights) == (None, None)
    assert (name in plain.ignored, name in noisy.ignored) == (True, False)


@pytest.mark.parametrize(("count", "read_"), [(64, True), (65, False)])
def test_an_archive_holds_at_most_64_arrays(tmp_path: Path, count: int, *, read_: bool):
    names = {f"a{k}": np.zeros(1) for k in range(count - 1)}
    arrays: dict[str, Any] = {"points": ARRAY, **names}
    np.savez(tmp_path / "a.npz", **arrays)
    if read_:
        assert read_cloud(tmp_path / "a.npz").points.tolist() == POINTS
    else:
        with pytest.raises(InvalidFileError, match="too many arrays"):
            read_cloud(tmp_path / "a.npz")


@pytest.mark.parametrize(("code", "size"), [(1, 24), (0, 23), (1, 23)])
def test_packed_points_of_a_process_that_failed_are_not_read(
    monkeypatch: pytest.MonkeyPatch, code: int, size: int
):
    done = subprocess.CompletedProcess([], code, stdout=bytes(size))
    monkeypatch.setattr(packed_scans.subprocess, "run", lambda *_, **__: done)
    with pytest.raises(InvalidFileError, match="its packed data are broken"):
        packed_scans._columns_of_packed(b"", Path("a.laz"))
