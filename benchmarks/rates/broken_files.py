"""Every reader on 1.7 million broken files; ARGS: another number.

A reader may only accept finite numbers of the right shape or raise InvalidFileError with one
printable line that names the file; within two seconds, and without much memory. Seeds are fixed.
"""

from __future__ import annotations

import io
import random
import re
import resource
import signal
import sys
import time
import warnings
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cloud_files as files
import numpy as np

from certreg.errors import InvalidFileError
from certreg.io.clouds import parse_cloud
from certreg.io.pairs import parse_pairs
from certreg.io.poses import parse_line, parse_pose

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg.geometry.given import GivenPose

ALL = 1_700_000
PATIENCE = 2.0  # seconds of processor time for one input; most have a few hundred bytes
MEMORY = 200 << 20  # bytes by which the peak may grow
LONGEST = 4096  # bytes of an input

POINTS = [[0.0, 0.5, -1.0], [1.0, 2.0, 3.0], [4.25, 5.0, 1e-3]]
FLOATS = [(axis, "F", 4, 1) for axis in "xyz"]
MORE = [("x", "F", 8, 1), ("n", "U", 1, 2), ("y", "I", 8, 1), ("z", "F", 4, 1), ("_", "I", 2, 1)]
ROWS = [[0.5, 1, 2, 3, 4.0, 5], [1.5, 2, 3, -4, 5.0, 6]]
MESH = [
    ("camera", [("float", "view")], [[1.0]]),
    (
        "vertex",
        [("float", "x"), ("uchar", "int", "some"), ("short", "y"), ("double", "z")],
        [[1.0, [1, 2], 3, 4.0], [5.0, [], 7, 8.0]],
    ),
    ("face", [("uchar", "int", "vertex_indices")], [[[0, 1, 0]], [[1, 0, 1]]]),
]
KINDS = ("ascii", "binary_little_endian", "binary_big_endian")
DATA = ("ascii", "binary", "binary_compressed")
ROOT = Path(__file__).resolve().parents[2]
OTHERS = ROOT / "tests" / "io" / "data"  # that other programs wrote
NAMED = ("vertex", [("int", "label"), *(("float", a) for a in ("x", "y", "z", "sigma"))])
CSV = [b"x,y,z\n1,2,3\n4,5,6\n", b'label,x,y,z,r\n"a, b",1,2,3,0\nc,4e1,-5,.6,1\n', b"1,2,3\r\n"]
CSV += [b"Point;N;E;H;weight\na;1,5;2;3;0\nb;4;5,25;6;1\n", b"P1,1,2,3\n", b"1;2;3\n"]
TXT = [b"# by hand\n1 2 3\n4\t5 6e-1\n", b"1, 2, 3, 9\n4,5,6,8\n"]
TXT += [b"//X Y Z R\n1 2 3 9\n", b"P1 1 2 3\nP2 4 5 6 \n", b"label n e h sigma\n1 2 3 4 5\n"]
PTS = [b"2\n1 2 3 -100 255 0 0\n4 5 6 -90 1 2 3\n", *TXT]
OBJ = [b"# o\nv 1 2 3\nv 4 5 6 1\nv 7 8 9 1 0 0\nvn 0 0 1\nf 1//1 2/1/1 -1\nl 1 2\n"]
XYZ = [b"2\nwater, cut\nO 0 0 0\nH 1 0.5 -1e-1 7\n", *TXT]
PLY = [files.ply(MESH, kind) for kind in KINDS] + [files.xyz_ply(POINTS, kind) for kind in KINDS]
PLY += [files.ply([(*NAMED, [[3, 1, 2, 3, 0.5], [4, 5, 6, 7, 2]])], kind) for kind in KINDS]
PCD = [files.pcd(f, r, d) for f, r in ((FLOATS, POINTS), (MORE, ROWS)) for d in DATA]
NPY = [files.npy(np.array(POINTS).astype(t)) for t in ("<f8", ">f4", "<i8", "u1", "f2")]
NPZ = [
    files.npz({"points": POINTS, "w": [1.0, 2.0]}, method)
    for method in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
]
OBJ += [file.read_bytes() for file in sorted(OTHERS.glob("*.obj"))]
STL = [file.read_bytes() for file in sorted(OTHERS.glob("*.stl"))]
STL += [b"solid a\n" + STL[-1].partition(b"\n")[2]]
LAS = [(OTHERS / "laspy.las").read_bytes()]  # of .laz, each takes a process: fewer, elsewhere
ATOM = b"ATOM      1  CA  LEU A  17A    -16.594  -4.293  -3.408  1.00 20.00           C  \n"
PDB = [ATOM + b"END\n", b"MODEL        1\n" + ATOM + b"ENDMDL\nEND\n"]
PDB += [(OTHERS / "gemmi.pdb").read_bytes()]
CIF = [(OTHERS / "gemmi.cif").read_bytes()]
CERTIFICATE = (
    b'{"about": {}, "basin": null, "claims": {"basin": null, "gap": [1, -9], "pattern": [1, 3], '
    b'"sdp_gap": null, "sin2_half_angle": null, "unique": true, "unstable": null}, "format": '
    b'"certreg-certificate/1", "kind": "isotropic", "optimality": {"delta": [1, -9], "mu": [1, 0]},'
    b'"pose": [1, 0, 2, 0], "problem": {"data": null, "digest": "0", "n": 3}, "sdp": null}'
)
POSE = [
    b"1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n",
    b"1 0 0 0 5 6 7\n",
    b'{"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "translation": [1, 2, 3]}',
    b'{"pose": {"quaternion_wxyz": [1, 0, 0, 0], "translation": [1, 2, 3]}}',
    b"1 0 0 5 0 1 0 6 0 0 1 7\n",
    b"1305031102.1753 5 6 7 0 0 0 1\n",
    files.npy(np.eye(4)[:3]),
    files.npy(np.eye(4)),
    CERTIFICATE,
]
POSE_LINES = [
    b"# time tx ty tz qx qy qz qw\n1 5 6 7 0 0 0 1\n2 5 6 7 0 1 0 0\n",
    b"1 0 0 5 0 1 0 6 0 0 1 7\n0,1,0,5,1,0,0,6,0,0,-1,7\n",
]
PAIRS = [b"source,target\n0,1\n1,0\n", b"2,1\n", files.npy(np.array([[0, 1], [2, 0]]))]
WORDS = (
    b" |\n|\r\n|,|;|\t|\"|'|#|-|+|.|e|E|_|\0|\xff|\xef\xbb\xbf|nan|inf|-inf|1e999|1e-999|0x1|-1|0|"
    b"1|2|3|255|256|65536|2147483648|4294967295|4294967296|9223372036854775808|99999999999999999999|"
    b"x|y|z|label|ply|format|ascii|binary|1.0|element|vertex|property|list|uchar|int|float|double|"
    b"char|uint|short|end_header|comment|FIELDS|SIZE|TYPE|COUNT|WIDTH|HEIGHT|POINTS|DATA|F|I|U|4|8|"
    b"binary_compressed|{|}|[|]|(|)|:|None|True|<f8|>f8|O|<U9|shape|descr|rotation|pose|translation|"
    b"PK\x01\x02|PK\x03\x04|PK\x05\x06|PK\x06\x07|\x93NUMPY\x01\0|\x93NUMPY\x02\0|points.npy|H|Si"
).split(b"|")


class TooSlowError(BaseException):
    """Nothing that a reader could catch by mistake."""


@dataclass(frozen=True)
class Reader:
    parse: Callable[[io.BytesIO], Any]
    seeds: list[bytes]
    name: str


@dataclass
class Count:
    inputs: int = 0
    accepted: int = 0
    slowest: float = 0.0


def cloud(suffix: str, seeds: list[bytes]) -> Reader:
    file = Path(f"fuzz{suffix}")

    def parse(stream: io.BytesIO) -> None:
        points = parse_cloud(stream, file).points
        assert points.dtype == np.float64
        assert points.ndim == 2
        assert points.shape[1] == 3
        assert len(points) > 0
        assert np.isfinite(points).all()

    return Reader(parse, seeds, str(file))


def pose(stream: io.BytesIO) -> None:
    _is_pose(parse_pose(stream, Path("fuzz.pose")))


def pose_line(stream: io.BytesIO) -> None:
    _is_pose(parse_line(stream, Path("fuzz.tum"), 2))


def _is_pose(given: GivenPose) -> None:
    shift = np.zeros(3) if given.translation is None else given.translation
    assert given.turn.shape in {(3, 3), (4,)}
    assert given.rotation.shape == (3, 3)
    assert shift.shape == (3,)
    assert np.isfinite([*given.rotation.ravel(), *shift]).all()


def pairs(suffix: str) -> Callable[[io.BytesIO], None]:
    def parse(stream: io.BytesIO) -> None:
        found = parse_pairs(stream, Path(f"fuzz{suffix}"), (3, 2))
        assert found.dtype == np.int64
        assert found.ndim == 2
        assert found.shape[1] == 2
        assert len(found) > 0
        assert (found >= 0).all()
        assert (found < [3, 2]).all()

    return parse


READERS = {
    "csv": cloud(".csv", CSV),
    "txt": cloud(".txt", TXT),
    "xyz": cloud(".xyz", XYZ),
    "ply": cloud(".ply", PLY),
    "pcd": cloud(".pcd", PCD),
    "pts": cloud(".pts", PTS),
    "obj": cloud(".obj", OBJ),
    "pdb": cloud(".pdb", PDB),
    "stl": cloud(".stl", STL),
    "las": cloud(".las", LAS),
    "cif": cloud(".cif", CIF),
    "npy": cloud(".npy", NPY),
    "npz": cloud(".npz", NPZ),
    "pose": Reader(pose, POSE, "fuzz.pose"),
    "line": Reader(pose_line, POSE_LINES, "fuzz.tum"),
    "pairs": Reader(pairs(".csv"), PAIRS[:2], "fuzz.csv"),
}


CHANGES: list[Callable[[random.Random, bytes, bytes, bytes], bytes]] = [
    lambda chance, part, tail, _: bytes(b ^ 1 << chance.randrange(8) for b in part) + tail,
    lambda chance, part, tail, _: chance.randbytes(len(part)) + tail,
    lambda _, __, tail, ___: tail,
    lambda chance, part, tail, _: part * chance.choice((2, 2, 3, 31)) + tail,
    lambda chance, _, tail, __: chance.choice(WORDS) + tail,
    lambda chance, part, tail, _: chance.choice(WORDS) + part + tail,
    lambda *_: b"",
    lambda chance, _, __, other: other[chance.randrange(len(other) + 1) :],
]


def mutated(chance: random.Random, content: bytes, other: bytes) -> bytes:
    """The content with one to four changes."""
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 1, 2, 2, 3, 4))):
        start = chance.randrange(len(data) + 1)
        end = min(len(data), start + chance.choice((1, 1, 2, 4, 8, 40)))
        if chance.randrange(6) == 0:  # a number, wherever one is
            spans = [found.span() for found in re.finditer(rb"[0-9]+", data)]
            start, end = chance.choice(spans or [(0, 0)])
            data[start:end] = chance.choice(WORDS)
        else:  # what is there, and what is behind it
            part, tail = bytes(data[start:end]), bytes(data[end:])
            data[start:] = chance.choice(CHANGES)(chance, part, tail, other)
    return bytes(data[:LONGEST])


def broken(name: str, chance: random.Random) -> bytes:
    """A broken file; in an archive, often, a whole archive of broken arrays."""
    seeds = READERS[name].seeds
    if name == "npz" and chance.randrange(2):
        arrays = [mutated(chance, chance.choice(NPY), chance.choice(NPY)) for _ in range(2)]
        titles = chance.choice((("points.npy", "b.npy"), ("a.npy", "b.npy"), ("a.npy", "b.txt")))
        method = chance.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))
        whole = files.archive(dict(zip(titles, arrays, strict=True)), method)
        return whole if chance.randrange(2) else mutated(chance, whole, whole)
    return mutated(chance, chance.choice(seeds), chance.choice(seeds))


def try_one(reader: Reader, content: bytes) -> bool:
    """Whether a file is accepted; anything but acceptance or a proper refusal is raised."""
    try:
        reader.parse(io.BytesIO(content))
    except InvalidFileError as error:
        message = str(error)
        assert message.isprintable()
        assert message.startswith(reader.name)
        assert len(message) < 1000
        return False
    return True


def fuzz(name: str, amount: int, seed: int = 0) -> Count:
    """Many broken files for one reader. Raises AssertionError with the file that did it."""
    chance, count, reader = random.Random(f"{name} {seed}"), Count(), READERS[name]
    before = signal.signal(signal.SIGVTALRM, _too_slow)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for _ in range(amount):
                content = broken(name, chance)
                signal.setitimer(signal.ITIMER_VIRTUAL, PATIENCE)
                start = time.process_time()
                try:
                    count.accepted += try_one(reader, content)
                except BaseException as error:
                    signal.setitimer(signal.ITIMER_VIRTUAL, 0)
                    message = f"{name}: {error!r} on {content!r}"
                    raise AssertionError(message) from error
                count.slowest = max(count.slowest, time.process_time() - start)
                count.inputs += 1
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)
    return count


def peak_memory() -> int:
    """Bytes; Linux tells kilobytes, macOS bytes."""
    scale = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale


def _too_slow(*_: object) -> None:
    raise TooSlowError


def main() -> None:
    amount = int(sys.argv[1]) if len(sys.argv) > 1 else ALL
    for name in READERS:  # what is loaded on first use is no growth
        fuzz(name, 50, seed=1)
    start, begun, total = peak_memory(), time.perf_counter(), 0
    print(f"{'reader':8}{'inputs':>10}{'accepted':>10}{'slowest':>12}{'peak growth':>14}")
    for name in READERS:
        count = fuzz(name, amount // len(READERS))
        growth = peak_memory() - start
        total += count.inputs
        assert count.accepted > count.inputs // 1000, f"{name}: hardly anything is accepted"
        assert growth < MEMORY, f"{name}: the peak grew by {growth} bytes"
        told = f"{count.slowest * 1e3:9.1f} ms{growth / 2**20:11.1f} MB"
        print(f"{name:8}{count.inputs:10}{count.accepted:10}{told}", flush=True)
    print(f"{total} inputs in {time.perf_counter() - begun:.0f} s: nothing but clean refusals")


if __name__ == "__main__":
    main()
