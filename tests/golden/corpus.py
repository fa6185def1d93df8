"""The input of the golden record: written once, read by every checkout that is recorded.

Only NumPy and the standard library, nothing of certreg: the same files whatever the code. Random
problems take their seed from their number.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from bad_files import BAD, CSV, USAGE, Bad

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parent.parent.parent
RANDOM = 200
MUTANTS = 8  # of each vector
PACKAGED = {
    "survey": ("survey_source", "survey_target"),
    "head": ("head_colin27", "head_fsaverage"),
    "abeta": ("abeta_2beg_model01", "abeta_2beg_model02"),
}
AXES = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
LINE = [[0, 0, 0], [1, 2, 3], [2, 4, 6], [5, 10, 15]]
BENT = [[0, 0, 0], [1, 2, 3], [2, 4, 7], [5, 9, 15]]

Points = Any  # N rows of three numbers


def stretched(x: float, y: float, z: float) -> Points:
    """The octahedron scaled along its axes: C = 2 diag of the products with another such one."""
    return [[a * x, b * y, c * z] for a, b, c in AXES]


ROWS: dict[str, tuple[Points, Points]] = {
    "1111": (stretched(3, 2, 1), stretched(3, 2, 1)),
    "1111-mirrored": (stretched(3, 2, 1), stretched(3, 2, -1)),
    "121": (stretched(2, 2, 0), stretched(2, 2, 0)),
    "112": (stretched(2, 1, 1), stretched(2, 1, 1)),
    "13": (AXES, AXES),
    "211": (stretched(2, 1, 1), stretched(2, 1, -1)),
    "31": (AXES, stretched(1, 1, -1)),
    "22": (LINE, BENT),
    "22-two-points": ([[0, 0, 0], [1, 0, 0]], [[5, 5, 5], [5, 6, 5]]),
    "4": (BENT, [[1, 2, 3]] * 4),
    "4-one-point": ([[1, 2, 3]], [[4, 5, 6]]),
    "4-cancelling": (AXES, [[1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1]]),
}


def write_corpus(folder: Path) -> None:
    """Every file that the recorded commands read."""
    _write_packaged(folder / "data")
    for name, (source, target) in ROWS.items():
        _write_pair(folder / "rows", name, np.array(source, float), np.array(target, float))
    for number in range(RANDOM):
        _write_random(folder / "random", number)
    for name, bad in bad_cases():
        _write_bad(folder / "bad" / name, bad)
    _write_formats(folder / "formats")
    _write_vectors(folder / "vectors")
    _write_list(folder / "list")
    (folder / "rough-pose.txt").write_text("0.7 0.1 -0.1 0.7 1 2 3\n", "utf-8")
    (folder / "scaled-pose.txt").write_text("2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n", "utf-8")
    (folder / "junk.json").write_bytes(b'{"format": "certreg-certificate/1"')


def bad_cases() -> Iterator[tuple[str, Bad]]:
    """Bad files and bad usage, by names that a file may have."""
    for name, bad in BAD.items():
        yield slug(name), bad
    for name, (options, words) in USAGE.items():
        yield f"usage-{slug(name)}", Bad({}, (words,), options)


def bad_arguments(bad: Bad, place: str) -> tuple[str, ...]:
    """The clouds and options of a bad case whose files are in the folder `place`."""
    names = list(bad.files)
    sides = [
        next((n for n in names if Path(n).stem == side), f"{side}.csv")
        for side in ("source", "target")
    ]
    clouds = (f"{place}/{name}" for name in bad.arguments or sides)
    return (*clouds, *(option.format(tmp=place) for option in bad.options))


def slug(name: str) -> str:
    """Words as the name of a file."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def text(points: NDArray[np.float64], labels: list[str] | None = None) -> str:
    """A cloud as .csv, as another program would write it."""
    rows = [",".join(map(repr, row)) for row in points.tolist()]
    if labels is not None:
        rows = ["label,x,y,z", *(f"{n},{row}" for n, row in zip(labels, rows, strict=True))]
    return "\n".join(rows) + "\n"


def rotation(rng: np.random.Generator) -> NDArray[np.float64]:
    """A random rotation matrix, by Rodrigues' formula for quaternions."""
    w, x, y, z = (q := rng.normal(size=4)) / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def random_pair(number: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Clouds of a kind, size, noise, offset and scale that change with the number."""
    rng = np.random.default_rng(number)
    n = (3, 4, 5, 8, 13, 40, 2, 1)[number % 8] if number % 5 else 20
    x = rng.normal(size=(n, 3))
    match number % 11:
        case 0:
            x[:, 2] = 0.0
        case 1:
            x = rng.integers(-9, 9, size=(n, 1)) * np.array([[1.0, 2.0, 3.0]])
        case 2:
            x = np.round(x * 4) / 4  # lattice points: exact sums, sometimes equal eigenvalues
        case 3:
            x = x * [1, 1, 1e-6]  # nearly flat
        case _:
            pass
    noise, offset = (0.01, 0.0, 0.3, 10.0)[number % 4], (0.0, 1.0, 1e6)[number % 3]
    scale = 2.0 ** float((0, 0, 0, 40, -40, 500, -500)[number % 7])
    shift = offset * rng.normal(size=3)
    y = x @ rotation(rng).T + shift + noise * rng.normal(size=(n, 3))
    if number % 13 == 0:
        y = y * [1, 1, -1]
    return x * scale, y * scale


def _write_pair(
    folder: Path, name: str, source: NDArray[np.float64], target: NDArray[np.float64]
) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}-source.csv").write_text(text(source), "utf-8")
    (folder / f"{name}-target.csv").write_text(text(target), "utf-8")


def _write_packaged(folder: Path) -> None:
    folder.mkdir(parents=True)
    for name in (name for pair in PACKAGED.values() for name in pair):
        (found,) = (ROOT / "certreg").rglob(f"{name}.csv")
        shutil.copy(found, folder)


def _write_random(folder: Path, number: int) -> None:
    source, target = random_pair(number)
    name = f"{number:03}"
    _write_pair(folder, name, source, target)
    rng = np.random.default_rng([number, 1])
    weights = 10.0 ** rng.uniform(-3, 3, size=len(source))
    (folder / f"{name}-weights.txt").write_text(
        "".join(f"{w!r}\n" for w in weights.tolist()), "utf-8"
    )
    turn = rotation(rng)
    shift = target.mean(axis=0) - turn @ source.mean(axis=0)
    matrix = np.vstack([np.column_stack([turn, shift]), [0.0, 0.0, 0.0, 1.0]])
    lines = (" ".join(map(repr, row)) for row in matrix.tolist())
    (folder / f"{name}-pose.txt").write_text("\n".join(lines) + "\n", "utf-8")


def _write_bad(folder: Path, bad: Bad) -> None:
    folder.mkdir(parents=True)
    names = {Path(name).stem for name in bad.files}
    missing = {f"{side}.csv": CSV for side in ("source", "target") if side not in names}
    for name, content in {**bad.files, **missing}.items():
        (folder / name).write_bytes(content)


def _write_formats(folder: Path) -> None:
    """One pair in every format that is read, with labels, with pairs, with weights."""
    folder.mkdir(parents=True)
    source, target = random_pair(14)
    n, rows = len(source), source.tolist()
    lines = [" ".join(map(repr, row)) for row in rows]
    (folder / "target.csv").write_text(text(target), "utf-8")
    (folder / "a.txt").write_text("# by hand\n" + "\n".join(lines) + "\n", "utf-8")
    (folder / "plain.xyz").write_text("\n".join(lines) + "\n", "utf-8")
    atoms = "\n".join(f"C {line}" for line in lines)
    (folder / "chemical.xyz").write_text(f"{n}\na comment\n{atoms}\n", "utf-8")
    axes = "".join(f"property double {axis}\n" for axis in "xyz")
    ply = f"ply\nformat ascii 1.0\nelement vertex {n}\n{axes}end_header\n"
    (folder / "ascii.ply").write_text(ply + "\n".join(lines) + "\n", "utf-8")
    binary = ply.replace("ascii", "binary_little_endian").encode()
    (folder / "binary.ply").write_bytes(binary + source.astype("<f8").tobytes())
    fields = "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\n"
    pcd = f"{fields}WIDTH {n}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n}\nDATA "
    (folder / "ascii.pcd").write_text(f"{pcd}ascii\n" + "\n".join(lines) + "\n", "utf-8")
    (folder / "binary.pcd").write_bytes(f"{pcd}binary\n".encode() + source.astype("<f8").tobytes())
    np.save(folder / "double.npy", source)
    np.save(folder / "single.npy", source.astype(np.float32))
    np.savez(folder / "points.npz", points=source)
    labels = [f"p{k}" for k in range(n)]
    (folder / "labelled.csv").write_text(text(source, labels), "utf-8")
    (folder / "reversed.csv").write_text(text(target[::-1], labels[::-1]), "utf-8")
    (folder / "fewer.csv").write_text(text(target[2:], labels[2:]), "utf-8")
    (folder / "extra.csv").write_text(
        "x,y,z,red\n" + "".join(f"{line.replace(' ', ',')},7\n" for line in lines), "utf-8"
    )
    (folder / "pairs.txt").write_text("".join(f"{k} {k}\n" for k in range(1, n)), "utf-8")
    (folder / "weights.txt").write_text("".join(f"{1 + k}\n" for k in range(n)), "utf-8")


def _write_vectors(folder: Path) -> None:
    """The published vectors, and beside each some with one number changed."""
    folder.mkdir(parents=True)
    for path in sorted((ROOT / "vectors").glob("*-*.json")):
        shutil.copy(path, folder)
        for k in range(MUTANTS):
            rng = np.random.default_rng([k, *path.name.encode()])
            (folder / f"mutant-{k}-of-{path.name}").write_text(
                _mutant(path.read_text("utf-8"), rng), "utf-8"
            )


def _mutant(certificate: str, rng: np.random.Generator) -> str:
    """The text with one of its numbers or truth values changed, mostly by little."""
    words = list(re.finditer(r"(?<=[\[ :,])-?\d+(?=[\],}\s])|\btrue\b|\bfalse\b", certificate))
    if not words:
        return certificate[: int(rng.integers(len(certificate)))]
    word = words[int(rng.integers(len(words)))]
    old = word.group()
    if old in {"true", "false"}:
        new = json.dumps(old == "false")
    else:
        new = str((int(old) + 1, int(old) - 1, 2 * int(old), -int(old))[int(rng.integers(4))])
    return certificate[: word.start()] + new + certificate[word.end() :]


def _write_list(folder: Path) -> None:
    """A list of pairs for `batch`: good ones, ambiguous ones, and two that cannot be read."""
    folder.mkdir(parents=True)
    lines = ["name,source,target,sigma,weights,damping,remark"]
    for number in range(0, 120, 6):
        pair = f"../random/{number:03}-source.csv,../random/{number:03}-target.csv"
        options = ("0.5,,", f",../random/{number:03}-weights.txt,", ",,optimal")[number // 6 % 3]
        lines.append(f"pair {number},{pair},{options},-")
    lines += ["missing,nowhere.csv,nowhere.csv,,,,", "row,../rows/22-source.csv,,,,,"]
    lines += [f"{name},../rows/{name}-source.csv,../rows/{name}-target.csv,,,," for name in ROWS]
    (folder / "pairs.csv").write_text("\n".join(lines) + "\n", "utf-8")
    (folder / "empty.csv").write_text("name,source,target\n", "utf-8")
    (folder / "misspelt.csv").write_text("source,target,sigm\na.csv,b.csv,1\n", "utf-8")
