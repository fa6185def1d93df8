"""A pose file that says two things is refused; what rounding makes of one thing is not."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import checked
from strategies import random_problem

import certreg
from certreg.certificate.count import count_certificate
from certreg.certificate.isotropic import produce
from certreg.errors import InvalidFileError
from certreg.geometry.pose_matrix import ROTATION_TOLERANCE
from certreg.io.poses import MAX_POSE_BYTES, parse_line, parse_pose
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments


def stated(apart: float) -> bytes:
    """A quarter turn as a quaternion, and a rotation that is turned further by a small angle."""
    c, s = math.cos(math.pi / 2 + apart), math.sin(math.pi / 2 + apart)
    half = math.sqrt(0.5)
    document = {
        "quaternion_wxyz": [half, 0.0, 0.0, half],
        "rotation": [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
        "translation": [1.0, 2.0, 3.0],
    }
    return json.dumps(document).encode()


@pytest.mark.parametrize("apart", [0.0, 0.99 * ROTATION_TOLERANCE])
def test_rotation_and_quaternion_that_agree_are_one_pose(apart: float):
    pose = parse_pose(io.BytesIO(stated(apart)), Path("pose.json"))

    assert pose.turn.shape == (4,)
    assert np.allclose(pose.rotation, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)


@pytest.mark.parametrize("apart", [1.01 * ROTATION_TOLERANCE, 0.1, math.pi, -1.01e-4])
def test_rotation_and_quaternion_that_disagree_are_refused(apart: float):
    with pytest.raises(InvalidFileError, match="are two different rotations: keep one") as caught:
        parse_pose(io.BytesIO(stated(apart)), Path("pose.json"))

    assert caught.value.limit == ROTATION_TOLERANCE == 1e-4
    assert str(caught.value).startswith("pose.json: ")


def printed(q: list[str]) -> dict[str, bytes]:
    """One pose in every format that takes a quaternion, its digits as they are."""
    w, x, y, z = q
    fields = f'{{"quaternion_wxyz": [{", ".join(q)}], "translation": [1, 2, 3]}}'
    return {
        "certreg": f"{w} {x} {y} {z} 1 2 3".encode(),
        "TUM": f"0.5 1 2 3 {x} {y} {z} {w}".encode(),
        "JSON": fields.encode(),
    }


@pytest.mark.parametrize("seed", range(5))
def test_a_quaternion_of_few_digits_stretches_no_points(seed: int):
    rng = np.random.default_rng(seed)
    q = next(
        digits
        for q in rng.normal(size=(1000, 4))
        for digits in (np.round(q / np.linalg.norm(q), 4),)
        if 3e-5 < abs(np.linalg.norm(digits) - 1.0) < ROTATION_TOLERANCE
    )
    points = rng.normal(size=(4, 3))
    for name, content in printed([str(entry) for entry in q.tolist()]).items():
        moved = parse_pose(io.BytesIO(content), Path("pose")).apply(points)

        sides, before = (np.linalg.norm(np.diff(c, axis=0), axis=1) for c in (moved, points))
        assert np.allclose(sides, before, rtol=1e-14, atol=0.0), name


# Files of other programs -------------------------------------------------------------------------

TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
HALF = math.sqrt(0.5)
KITTI = "0 -1 0 1 1 0 0 2 0 0 1 3"
TUM = f"1305031102.17 1 2 3 0 0 {HALF} {HALF}"
CERTREG = f"{HALF} 0 0 {HALF} 1 2 3"
MATRIX = np.vstack([np.column_stack([TURN, [1.0, 2, 3]]), [0, 0, 0, 1]])
ROWS = "\n".join(" ".join(map(str, row)) for row in MATRIX.tolist())


def npy(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


FORMS: dict[str, bytes] = {
    "4x4": ROWS.encode(),
    "3x4": ROWS.rsplit("\n", 1)[0].encode(),
    "3x4 with commas": ROWS.rsplit("\n", 1)[0].replace(" ", ",").encode(),
    "KITTI": KITTI.encode(),
    "TUM": TUM.encode(),
    "TUM with a comment": f"# timestamp tx ty tz qx qy qz qw\n{TUM}\n".encode(),
    "TUM with commas": TUM.replace(" ", ", ").encode(),
    "npy 4x4": npy(MATRIX),
    "npy 3x4": npy(MATRIX[:3]),
    "npy of integers": npy(MATRIX.astype(int)),
    "npy of floats": npy(MATRIX.astype(np.float32)),
}


@pytest.mark.parametrize("name", FORMS)
def test_every_file_of_a_pose_is_read(name: str):
    pose = parse_pose(io.BytesIO(FORMS[name]), Path("pose"))

    assert np.allclose(pose.rotation, TURN, atol=1e-15)
    assert np.array_equal(checked(pose.translation), [1.0, 2.0, 3.0])


@pytest.mark.parametrize("text", [KITTI, TUM, CERTREG])
@pytest.mark.parametrize("line", [1, 3, 4])
def test_a_line_is_chosen_and_counted_as_an_editor_counts(text: str, line: int):
    other = text.replace("3", "7")
    lines = [other, "# a comment", other, other]
    lines[line - 1] = text
    content = "\n".join(lines).encode()
    pose = parse_line(io.BytesIO(content), Path("many.txt"), line)

    assert np.allclose(pose.apply(np.eye(3)), np.eye(3) @ TURN.T + [1, 2, 3], atol=1e-15)
    with pytest.raises(InvalidFileError, match=r"holds 3 poses, one a line .*: choose one with "):
        parse_pose(io.BytesIO(content), Path("many.txt"))


def test_the_lines_to_choose_from_are_counted_with_the_comments():
    content = f"# a\n# b\n\n{KITTI}\n# c\n{KITTI}\n# d\n".encode()
    with pytest.raises(InvalidFileError, match=r"holds 2 poses.* with --line N, from 4 to 6$"):
        parse_pose(io.BytesIO(content), Path("many.txt"))
    for line in (4, 6):
        assert checked(parse_line(io.BytesIO(content), Path("many.txt"), line).translation)[2] == 3


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (2, "many.txt, line 2: holds 0 numbers: a line that is a pose holds 7 (w x y z tx"),
        (3, "many.txt, line 3: holds 4 numbers"),
        (4, "many.txt, line 4: 'x' is not a number: write a 4x4 matrix"),
        (5, "many.txt, line 5: the quaternion has norm 2, not 1"),
        (6, "many.txt has 5 lines: --line 6 is none of them"),
    ],
)
def test_a_line_that_is_no_pose_is_one_clear_error(line: int, words: str):
    content = f"{KITTI}\n\n1 0 0 0\n{TUM} x\n1 0 0 0 2 0 0 0\n"
    with pytest.raises(InvalidFileError) as caught:
        parse_line(io.BytesIO(content.encode()), Path("many.txt"), line)

    assert str(caught.value).startswith(words)
    assert caught.value.line == line


def test_a_long_trajectory_is_read_up_to_its_line_only():
    content = io.BytesIO(f"{KITTI}\n".encode() * 50_000)
    with pytest.raises(InvalidFileError, match="choose a line with --line N"):
        parse_pose(content, Path("many.txt"))
    content.seek(0)
    parse_line(content, Path("many.txt"), 7)

    assert content.tell() == 7 * (len(KITTI) + 1)


WRONG_ARRAYS = {
    "a rotation": (np.eye(3), r"holds an array \(3, 3\), a pose is .*: save \[R \| t\]"),
    "a stack": (np.stack([np.eye(4)] * 2), "a stack of 2: save one of them"),
    "a number": (np.float64(3.0), r"holds an array \(\)"),
    "its last row": (2.0 * np.eye(4), "last row of the pose matrix must be 0 0 0 1"),
    "NaN": (np.full((4, 4), np.nan), "every value must be finite"),
    "complex": (1j * np.eye(4), "not real numbers"),
}


@pytest.mark.parametrize("name", WRONG_ARRAYS)
def test_an_array_that_is_no_pose_is_refused(name: str):
    array, words = WRONG_ARRAYS[name]
    with pytest.raises(InvalidFileError, match=words) as caught:
        parse_pose(io.BytesIO(npy(np.asarray(array))), Path("pose.npy"))

    assert str(caught.value).startswith("pose.npy: ")


def test_an_array_of_objects_is_never_unpickled():
    stream = io.BytesIO()
    np.save(stream, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(InvalidFileError, match="not real numbers"):
        parse_pose(io.BytesIO(stream.getvalue()), Path("pose.npy"))


def test_a_certificate_is_a_rotation_alone_however_many_points_it_carries():
    rng = np.random.default_rng(3)
    for n in (5, 20_000):
        problem = random_problem(rng, n=n)
        objective = Isotropic(exact_moments(problem))
        content = checked(produce(problem, objective)).to_json()
        pose = parse_pose(io.BytesIO(content), Path("certificate.json"))

        assert (len(content) > MAX_POSE_BYTES) == (n == 20_000)
        assert pose.translation is None
        q = np.array(objective.quaternions[0], dtype=float)
        assert np.allclose(pose.turn, q / np.linalg.norm(q), atol=1e-9)
    spoilt = content.replace(b'"kind": "isotropic"', b'"kind": "other"')
    with pytest.raises(InvalidFileError, match="neither a pose file nor a well-formed certificate"):
        parse_pose(io.BytesIO(spoilt), Path("certificate.json"))


def test_a_certificate_of_wrong_pairs_holds_the_rotation_of_its_least_squares():
    problem = random_problem(np.random.default_rng(4), n=8, noise=0.001)
    normals = np.eye(3)[np.arange(8) % 3]
    stated: tuple[dict[str, Any], ...] = ({}, {"normals": normals}, {"scale": "asymmetric"})
    for more in stated:
        clouds = problem.source, problem.target
        made: Any = certreg.certify(*clouds, max_residual=0.05, **more)
        content = made.certificate.to_json()
        pose = parse_pose(io.BytesIO(content), Path("certificate.json"))
        assert pose.translation is None
        assert np.allclose(pose.rotation, made.pose.rotation, rtol=0, atol=1e-12)
        for fit in (None, {"pose": [1, 2, 3]}, {"pose": [1.0, 0, 0, 0]}, {"proof": [1]}):
            spoilt = json.dumps({**json.loads(content), "fit": fit}).encode()
            with pytest.raises(InvalidFileError, match="is a certificate that holds no pose"):
                parse_pose(io.BytesIO(spoilt), Path("certificate.json"))


def test_a_certificate_of_a_count_holds_no_pose():
    problem = random_problem(np.random.default_rng(4), n=5)
    content = checked(count_certificate(problem)).to_json()
    with pytest.raises(InvalidFileError, match="is a certificate that holds no pose"):
        parse_pose(io.BytesIO(content), Path("count.json"))
