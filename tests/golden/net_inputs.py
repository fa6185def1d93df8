"""The files that the cases of the light net read: few points, sums that are exact, or nearly.

A step names a file, and so it is written. Noise is drawn, and rounded to 1/1024.
"""

from __future__ import annotations

import json
import math
import shutil
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from bad_files import npy
from corpus import AXES, BENT, LINE, ROOT, ROWS, stretched, text

if TYPE_CHECKING:
    from collections.abc import Iterable

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # a quarter about z
TILT = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, -0.8], [0.0, 0.8, 0.6]])  # 53 degrees about x
SHIFT = np.array([1.0, -2.0, 3.5])
FAR = 2.0**46  # doubles there are 1/64 apart
LABELS = [f"P{k}" for k in range(12)]
Files = dict[str, bytes]


def write(steps: Iterable[str]) -> None:
    """The files named in the steps, and those that they name, into this folder."""
    wanted = " ".join(steps)
    known = files()
    wanted += "".join(known[name].decode() for name in known if name in wanted and "list" in name)
    for name, content in known.items():
        if name in wanted:
            Path(name).write_bytes(content)
    for folder in ("vectors", "certreg/data"):
        for path in (ROOT / folder).iterdir():
            if path.name in wanted:
                shutil.copy(path, ".")


def rounded(points: Any) -> Any:
    return np.round(np.asarray(points, float) * 1024.0) / 1024.0


@cache
def clouds() -> dict[str, Any]:
    """Clouds by the names of their files."""
    rng = np.random.default_rng(16)
    cloud = rounded(rng.normal(size=(12, 3)) * [3.0, 2.0, 1.0] + [5.0, 0.0, -2.0])
    noise = rng.normal(size=(12, 3))
    moved = cloud @ TURN.T + SHIFT
    noisy = rounded(moved + 0.02 * noise)
    outlier, two, pair = noisy.copy(), noisy.copy(), noisy.copy()
    outlier[3] += [40.0, -30.0, 20.0]
    two[[2, 7]] += [[9.0, 0.0, 8.0], [0.0, -9.0, 9.0]]
    pair[[1, 5]] = pair[[5, 1]]
    axes, narrow = np.array(stretched(3, 2, 1)), np.array(stretched(2, 1, -1.0 + 2.0**-12))
    needle = np.array(stretched(4, 2.0**-4, 2.0**-5))
    ways = np.vstack([AXES, AXES, [[0.0, 0.0, 4.0]]])  # turned about z both ways, one row longer
    both = np.vstack([AXES @ TURN.T, AXES @ TURN, [[0.0, 0.0, 1.0]]])
    both[6] += [2.0**-22, 0.0, 0.0]  # so little is no proof, and which of the two is told is fixed
    many = np.array([[k % 7, k % 5, k % 3] for k in range(40)], float)
    return {
        "axes": axes,
        "turned": axes @ TURN.T + [1.0, 2.0, 3.0],
        "half": axes * [-1.0, -1.0, 1.0],  # released there the body stands at a saddle
        "mirrored": stretched(3, 2, -1),
        "short": stretched(2, 1, 1),
        "narrow": narrow,
        "needle": needle,
        "needled": needle @ TURN.T + rounded(noise[:6]) * 2.0**-14,
        "ways": ways,
        "bothways": both,
        "hair": [[0.0, 2.0**-23, 1.0], [0.0, 0.0, 2.0], [0.0, 0.0, -3.0]],
        "flat": axes * [1.0, 1.0, 0.0],
        "large": axes * 1000.0,
        "one": [[0.1, 0.1, 0.1]],
        "other": [[0.7, 0.7, 0.7]],
        "shifted": [[4.0, 6.0, 15.0]] * 6,
        "cloud": cloud,
        "moved": moved,
        "noisy": noisy,
        "noisier": rounded(moved + 0.6 * noise),
        "tilted": rounded(cloud @ TURN.T @ TILT.T + SHIFT + 0.02 * noise),
        "outlier": outlier,
        "outliers": two,
        "exchanged": pair,
        "scaled": rounded(1.04 * moved + 0.02 * noise),
        "inches": 25.4 * noisy,
        "ppm": 1.0005 * moved,
        "twice": 2.0 * noisy,
        "reflected": rounded(noisy * [1.0, 1.0, -1.0]),
        "shuffled": noisy[rng.permutation(12)],
        "rolled": np.roll(noisy, 1, axis=0),
        "unlike": rounded(rng.normal(size=(12, 3)) * [9.0, 0.1, 0.1]),
        "far": moved + FAR,
        "farther": moved + 8.0 * FAR,
        "flatly": noisy * [1.0, 1.0, 0.0],
        "tiny": axes * 2.0**-30,
        "huge": axes * 1e170,
        "huger": axes * 5.9e307,
        "wide": axes @ TURN.T * 1e-170,
        "many": many,
        "manymoved": rounded(many @ TURN.T + 0.05 * rng.normal(size=(40, 3))),
        **{f"{name}-{side}": pair[k] for name, pair in ROWS.items() for k, side in SIDES},
        "line": LINE,
        "bent": BENT,
        "cube": AXES,
    }


SIDES = ((0, "source"), (1, "target"))


@cache
def files() -> Files:
    """All files, by name."""
    told = {f"{name}.csv": text(np.asarray(c, float)).encode() for name, c in clouds().items()}
    return {**told, **_labelled(), **_springs(), **_formats(), **_poses(), **_lists(), **_broken()}


def _labelled() -> Files:
    source, target = clouds()["cloud"], clouds()["noisy"]
    wrong = clouds()["outliers"]
    head = "label,x,y,z,sigma\n"
    rows = [
        f"{n},{','.join(map(repr, p))},0.02" for n, p in zip(LABELS, target.tolist(), strict=True)
    ]
    return {
        "labelled.csv": text(source, LABELS).encode(),
        "labels.csv": text(target[::-1], LABELS[::-1]).encode(),
        "labelledwrong.csv": text(wrong, LABELS).encode(),
        "fewer.csv": text(target[2:], LABELS[2:]).encode(),
        "sigmas.csv": (head + "\n".join(rows) + "\n").encode(),
        "weights.txt": "".join(f"{1 + k % 3}\n" for k in range(12)).encode(),
        "zero.txt": b"0\n" * 12,
        "some.txt": b"1\n1\n0\n1\n" * 3,
        "kept.txt": b"1\n1\n1\n1\n0\n0\n",
        "swapped.txt": b"1\n1\n0\n0\n1\n1\n",
        "pairs.txt": "".join(f"{k} {k}\n" for k in range(1, 12)).encode(),
        "outside.txt": b"0 0\n1 12\n",
        "three.txt": b"0 0 0\n",
        "whole.txt": b"source,target\n0,0\n1,1\n2,2.0\n3,3.5\n",
        "nopairs.txt": b"",
        "others.csv": text(target, [f"Q{k}" for k in range(12)]).encode(),
        "double.csv": text(target, ["P0", *LABELS[:11]]).encode(),
        "ids.csv": text(source, LABELS).replace("label", "id").encode(),
        "ids2.csv": text(target[::-1], LABELS[::-1]).replace("label", "id").encode(),
        "semicolons.csv": b"x;y;z\n0,5;0;0\n1;0;0\n0;2;0\n0;0;3\n",
        "plain.csv": b"0.5,0,0\n1,0,0\n0,2,0\n0,0,3\n",
        "again.txt": b"0 0\n0 1\n1 1\n2 2\n3 3\n",
    }


def _springs() -> Files:
    """Targets with what their springs are made of in further columns, and files of these alone."""
    source, target = clouds()["cloud"], clouds()["noisy"]
    axes = np.eye(3)[np.arange(12) % 3]
    normals = axes + np.eye(3)[np.arange(12) // 3 % 3]
    walls = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])[np.arange(12) % 2]
    half = np.array([[1.0, 2.0, 2.0], [2.0, 1.0, -2.0], [2.0, -2.0, 1.0], [3.0, 0.0, 0.0]])
    ball = np.concatenate([half, -half])
    wide = np.array([[1.0, 0.0, 0.0, 4.0, 0.0, 9.0], [4.0, 1.0, 0.0, 2.0, 0.0, 1.0]])[
        np.arange(12) % 2
    ]
    empty = np.arange(12) % 2 == 0
    some, others = normals.copy(), axes.copy()
    some[empty], others[~empty] = np.nan, np.nan

    def table(head: str, *columns: Any) -> bytes:
        rows = np.column_stack(columns).tolist()
        cells = (",".join("" if np.isnan(c) else repr(c) for c in row) for row in rows)
        return (head + "\n" + "\n".join(cells) + "\n").encode()

    planes, n = "x,y,z,nx,ny,nz", "nx,ny,nz"
    return {
        "planes.csv": table(planes, target, normals),
        "wall.csv": table(planes, target, walls[:1].repeat(12, axis=0)),
        "walls.csv": table(planes, target, walls),
        "ball.csv": table("x,y,z", ball),
        "sphere.csv": table(planes, ball, ball),
        "five.csv": table("x,y,z", source[:5]),
        "fiveplanes.csv": table(planes, target[:5], normals[:5]),
        "six.csv": table("x,y,z", source[:6]),
        "sixplanes.csv": table(planes, target[:6], normals[3:9]),
        "lines.csv": table("x,y,z,dx,dy,dz", target, axes),
        "full.csv": table("x,y,z,cxx,cxy,cxz,cyy,cyz,czz", target, wide),
        "some.csv": table(n, some),
        "rest.csv": table("dx,dy,dz", others),
        "pointless.csv": table(planes, target, normals * (np.arange(12) != 7)[:, None]),
    }


def _formats() -> Files:
    points = clouds()["cloud"]
    lines = "\n".join(" ".join(map(repr, row)) for row in points.tolist())
    axes = "".join(f"property double {axis}\n" for axis in "xyz")
    ply = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n{axes}end_header\n"
    return {
        "cloud.xyz": f"{lines}\n".encode(),
        "atoms.xyz": f"{len(points)}\nwater\n{lines}\n".replace("\n", "\nC ", 0).encode(),
        "cloud.ply": f"{ply}{lines}\n".encode(),
        "cloud.npy": npy(points),
    }


def _poses() -> Files:
    def line(*numbers: float) -> bytes:
        return (" ".join(map(repr, numbers)) + "\n").encode()

    def matrix(turn: Any, shift: Any) -> bytes:
        rows = np.vstack([np.column_stack([turn, shift]), [0.0, 0.0, 0.0, 1.0]])
        return b"".join(line(*row) for row in rows.tolist())

    root, shift = math.sqrt(0.5), SHIFT.tolist()
    source = clouds()["cloud"].mean(axis=0)
    near = math.radians(0.02)
    nudged = np.array(
        [
            [0.0, -1.0, 0.0],
            [math.cos(near), 0, -math.sin(near)],
            [math.sin(near), 0, math.cos(near)],
        ]
    )
    return {
        "right.txt": matrix(TURN, SHIFT),
        "axesright.txt": matrix(TURN, [1.0, 2.0, 3.0]),
        "axesturn.txt": matrix(TURN, [0.0, 0.0, 0.0]),
        "near.txt": matrix(nudged, SHIFT),
        "off.txt": matrix(TILT @ TURN, SHIFT),
        "shiftedoff.txt": matrix(TURN, SHIFT + np.array([0.0, 0.0, 4.0])),
        "identity.txt": matrix(np.eye(3), [0.0, 0.0, 0.0]),
        "halfturn.txt": matrix(TURN @ np.diag([-1.0, -1.0, 1.0]), [1.0, 2.0, 3.0]),
        "halfx.txt": matrix(TURN @ np.diag([1.0, -1.0, -1.0]), [1.0, 2.0, 3.0]),
        "inverse.txt": matrix(TURN.T, -TURN.T @ SHIFT),
        "transposed.txt": matrix(TURN.T, SHIFT),
        "transposedbest.txt": matrix(TURN.T, clouds()["noisy"].mean(axis=0) - TURN.T @ source),
        "scalarlast.txt": line(0.0, 0.0, root, root, *shift),
        "scalarfirst.txt": line(0.0, root, root, 0.0, *shift),
        "centred.txt": matrix(TURN, [0.0, 0.0, 0.0]),
        "centredsource.txt": matrix(TURN, clouds()["noisy"].mean(axis=0)),
        "centredtarget.txt": matrix(TURN, -TURN @ source),
        "millimetres.txt": matrix(TURN, 1000.0 * SHIFT),
        "similar.txt": matrix(2.0 * TURN, SHIFT),
        "reflection.txt": matrix(np.diag([1.0, 1.0, -1.0]), SHIFT),
        "inexact.txt": matrix(np.round(TURN + 4e-7 * TILT, 7), SHIFT),
        "unit.txt": line(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        "kitti.txt": line(*np.column_stack([TURN, SHIFT]).ravel().tolist()),
        "list.json": json.dumps(
            np.vstack([np.column_stack([TURN, SHIFT]), [0, 0, 0, 1]]).tolist()
        ).encode(),
        "rows.json": json.dumps(
            {"T_target_source": np.column_stack([TURN, SHIFT]).tolist()}
        ).encode(),
        "rotationalone.json": json.dumps({"rotation": TURN.tolist()}).encode(),
        "matrix.json": json.dumps({"rotation": TURN.tolist(), "translation": shift}).encode(),
        "twopose.json": json.dumps(
            {"rotation": TURN.tolist(), "quaternion_wxyz": [1, 0, 0, 0], "translation": shift}
        ).encode(),
        "short.json": json.dumps({"rotation": [[1, 0], [0, 1]], "translation": shift}).encode(),
        "words.json": json.dumps({"rotation": "no", "translation": shift}).encode(),
        "pose.npy": npy(np.column_stack([TURN, SHIFT])),
        "stack.npy": npy(np.zeros((5, 4, 4))),
        "three.npy": npy(np.eye(3)),
        "three-by-three.txt": line(1.0, 0, 0) + line(0.0, 1, 0) + line(0.0, 0, 1),
        "projective.txt": line(1.0, 0, 0, 0)
        + line(0.0, 1, 0, 0)
        + line(0.0, 0, 1, 0)
        + line(1.0, 2, 3, 1),
        "norm.txt": line(0.9, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0),
        "five.txt": line(1.0, 2.0, 3.0, 4.0, 5.0),
        "word.txt": b"1 0 0 0 1 2 three\n",
        "rotation.json": json.dumps(
            {"quaternion_wxyz": [root, 0, 0, root], "translation": shift}
        ).encode(),
        "tum.txt": b"".join(line(k, *shift, 0.0, 0.0, root, root) for k in (0.0, 0.1)),
    }


def _lists() -> Files:
    return {
        "list.csv": (
            b"name,source,target,sigma,weights,damping,remark\n"
            b"good,cloud.csv,noisy.csv,0.02,,,seen\n"
            b",axes.csv,turned.csv,,,2.0,\n"
            b"weighed,cloud.csv,noisy.csv,,weights.txt,optimal,\n"
            b"ambiguous,22-source.csv,22-target.csv,,,,\n"
            b"poor,cloud.csv,outlier.csv,,,,\n"
            b"far,cloud.csv,far.csv,,,,\n"
            b"gone,nowhere.csv,noisy.csv,,,,\n"
            b"wrong,cloud.csv,axes.csv,,,,\n"
        ),
        "short-list.csv": (
            b"name,source,target,sigma,weights,damping,remark\n"
            b"ambiguous,22-source.csv,22-target.csv,,,,\n"
            b"gone,nowhere.csv,noisy.csv,,,,\n"
        ),
        "wrong-list.csv": (
            b"label,source,target,sigma,weights,pairs,match\n"
            b"both,cloud.csv,noisy.csv,1,weights.txt,,\n"
            b"pairs,cloud.csv,noisy.csv,,,pairs.txt,common\n"
            b"match,cloud.csv,noisy.csv,,,,some\n"
            b"match,cloud.csv,noisy.csv,,,,all\n"
            b"short,cloud.csv\n"
            b",,noisy.csv,,,,\n"
            b"sigma,cloud.csv,noisy.csv,much,,,\n"
            b"named,labelled.csv,fewer.csv,,,,common\n"
        ),
        "header-list.csv": b"source,source,sigma\na.csv,b.csv,1\n",
        "nothing-list.csv": b"",
        "misspelt-list.csv": b"source,target,sigm\na.csv,b.csv,1\n",
        "empty-list.csv": b"name,source,target\n",
    }


def _broken() -> Files:
    return {
        "word.csv": b"0,0,0\n1,two,3\n",
        "ragged.csv": b"0,0,0\n1,0\n",
        "nan.csv": b"0,0,0\n1,nan,3\n",
        "junk.json": b'{"format": "certreg-certificate/1"',
        "stamp.txt": b"a\x1b[31mb\n",
    }
