"""General springs from columns and files: each row goes where its row of the target goes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import commands
import numpy as np
import pytest

import certreg
from certreg.errors import CertregError, InvalidFileError, InvalidProblemError
from certreg.io.objects import stated_problem
from certreg.io.pairing import BY_LABEL, Pairing
from certreg.io.problems import read_problem
from certreg.io.springs import SpringSource, _of_target

RNG = np.random.default_rng(11)
X, Y, N = (RNG.standard_normal((5, 3)) for _ in range(3))
N /= np.linalg.norm(N, axis=1, keepdims=True)
ROOTS = RNG.standard_normal((5, 3, 3))
SPD = (ROOTS @ ROOTS.transpose(0, 2, 1)).reshape(5, 9)[:, [0, 1, 2, 4, 5, 8]]
PLANES = certreg.RegistrationProblem(X, Y, normals=N)
NAMES = list("abcde")
BACK = slice(None, None, -1)
Write = Callable[..., Path]


def _lines(columns: str, rows: np.ndarray, labels: list[str] | None, separator: str) -> list[str]:
    texts = [["" if np.isnan(value) else repr(float(value)) for value in row] for row in rows]
    if labels is not None:
        texts = [[label, *text] for label, text in zip(labels, texts, strict=True)]
    head = columns if labels is None else f"label,{columns}"
    return [head.replace(",", separator), *(separator.join(text) for text in texts)]


@pytest.fixture(name="write")
def _write(tmp_path: Path) -> Write:
    def write(
        name: str,
        columns: str,
        rows: np.ndarray,
        labels: list[str] | None = None,
        separator: str = ",",
    ) -> Path:
        path = tmp_path / name
        path.write_text("\n".join([*_lines(columns, rows, labels, separator), ""]), "utf-8")
        return path

    return write


def _read(source: Path, target: Path, *columns: str, pairing: Pairing = BY_LABEL, **files: Path):
    springs = SpringSource(columns=columns, files=files)
    return read_problem(source, target, springs=springs, pairing=pairing)


def test_columns_of_the_target_are_springs_and_not_told_as_unused(write: Write) -> None:
    source = write("a.csv", "x,y,z", X)
    target = write("b.csv", "x,y,z,NX, ny,nz,colour", np.column_stack([Y, N, np.ones(5)]))

    problem, pair = _read(source, target, "plane")

    assert problem.digest() == PLANES.digest()
    assert [note for note in pair.notes if "not used: colour" in note]
    assert not [note for note in pair.notes if "nx" in note]


@pytest.mark.parametrize("separator", [",", ";"])
def test_each_kind_is_read_from_columns_and_from_files(
    write: Write, tmp_path: Path, separator: str
) -> None:
    source = write("a.csv", "x,y,z", X)
    target = write("b.csv", "x,y,z,cxx,cxy,cxz,cyy,cyz,czz", np.column_stack([Y, SPD]))
    six = write("six.csv", "xx,xy,xz,yy,yz,zz", SPD, separator=separator)
    three = write("three.txt", "# lx ly lz", N, separator=" ")
    three.write_text(three.read_text("utf-8").replace(",", " "), "utf-8")
    lower = write("lower.csv", "l11,l21,l22,l31,l32,l33", SPD)
    np.save(tmp_path / "d.npy", N)
    np.save(tmp_path / "w.npy", SPD[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(5, 3, 3))

    def digest(**given: Any) -> str:
        return certreg.RegistrationProblem(X, Y, **given).digest()

    assert _read(source, target, "full")[0].digest() == digest(covariances=SPD)
    assert _read(source, target, covariances=six)[0].digest() == digest(covariances=SPD)
    assert _read(source, target, information=six)[0].digest() == digest(information=SPD)
    assert _read(source, target, information=tmp_path / "w.npy")[0].digest() == digest(
        information=SPD
    )
    assert _read(source, target, directions=tmp_path / "d.npy")[0].digest() == digest(directions=N)
    assert _read(source, target, factors=three)[0].digest() == PLANES.digest()
    assert _read(source, target, factors=lower)[0].digest() == digest(factors=SPD)


def test_springs_go_with_the_rows_of_the_target(write: Write, tmp_path: Path) -> None:
    source = write("a.csv", "x,y,z", X, NAMES)
    target = write("b.csv", "x,y,z,nx,ny,nz", np.column_stack([Y, N])[BACK], NAMES[BACK])
    beside = write("n.csv", "nx,ny,nz", N[BACK])
    labelled = write("l.csv", "nx,ny,nz", N[[2, 0, 1, 4, 3]], [NAMES[k] for k in (2, 0, 1, 4, 3)])
    pairs = tmp_path / "pairs.csv"
    pairs.write_text("0,4\n1,3\n2,2\n3,1\n4,0\n", "utf-8")

    assert _read(source, target, "plane")[0].digest() == PLANES.digest()
    assert _read(source, target, normals=beside)[0].digest() == PLANES.digest()
    assert _read(source, target, normals=labelled)[0].digest() == PLANES.digest()
    paired = _read(source, target, "plane", pairing=Pairing(pairs=pairs))[0]
    assert paired.digest() == PLANES.digest()


def test_certify_of_clouds_in_memory_takes_springs_by_row_of_the_target(write: Write) -> None:
    source = write("a.csv", "x,y,z", X, NAMES)
    target = write("b.csv", "x,y,z,nx,ny,nz", np.column_stack([Y, N])[BACK], NAMES[BACK])
    loaded = certreg.load(target)

    assert loaded.normals is not None
    assert loaded.ignored == ()
    for normals in (N[BACK], loaded, loaded.normals, target, str(target)):
        problem, _ = stated_problem(certreg.load(source), loaded, normals=normals)
        assert problem.digest() == PLANES.digest()
    with pytest.raises(InvalidProblemError, match="normals has shape"):
        stated_problem(source, target, normals=N[:4])
    with pytest.raises(InvalidProblemError, match="has no normals"):
        stated_problem(target, source, normals=certreg.load(source))
    with pytest.raises(InvalidProblemError, match="turn with the rotation"):
        stated_problem(loaded, source, normals=loaded)


def test_a_pair_is_unpacked_with_its_springs_in_the_order_of_the_pairs(write: Write) -> None:
    source = write("a.csv", "x,y,z", X, NAMES)
    target = write("b.csv", "x,y,z,nx,ny,nz", np.column_stack([Y, N])[BACK], NAMES[BACK])

    first, second = certreg.pair(certreg.load(source), certreg.load(target))

    problem = certreg.RegistrationProblem(first, second, normals=second)
    assert problem.digest() == PLANES.digest()


def test_empty_cells_are_of_other_kinds(write: Write) -> None:
    normals, directions = N.copy(), N.copy()
    normals[3:], directions[[0, 1, 2, 4]] = np.nan, np.nan
    source = write("a.csv", "x,y,z", X)
    target = write("b.csv", "x,y,z,nx,ny,nz,dx,dy,dz", np.column_stack([Y, normals, directions]))

    problem, pair = _read(source, target, "plane", "line")

    assert problem.springs is not None
    assert problem.springs.ranks == (0, 3, 1, 1)
    assert any("1 pairs have no kind of spring" in note for note in pair.notes)


@pytest.mark.parametrize(
    ("columns", "rows", "words"),
    [
        ("nx,ny", N[:, :2], "names no normals: add columns nx,ny,nz"),
        ("nx,ny,nz", N[:4], "holds 4 rows of normals, the target has 5 points"),
        ("nx,ny,nz", np.where(np.eye(5, 3, k=-2) > 0, np.nan, N), "line 4: nx is empty, other"),
        ("nx,ny,nz", np.where(np.arange(5)[:, None] == 2, 0.0, N), "row 2 .* needs a length"),
        ("nx,ny,nz", np.where(np.arange(5)[:, None] == 2, np.nan, N), "row 2 .* is NaN"),
        ("nx,ny,nz,nx", np.column_stack([N, N[:, 0]]), "names no normals"),
    ],
)
def test_a_bad_file_is_one_line_that_names_its_place(
    write: Write, columns: str, rows: np.ndarray, words: str
) -> None:
    source, target = write("a.csv", "x,y,z", X), write("b.csv", "x,y,z", Y)
    normals = write("n.csv", columns, rows)

    with pytest.raises(CertregError, match=words) as caught:
        _read(source, target, normals=normals)

    assert "\n" not in str(caught.value)


def test_text_that_is_no_number_and_rows_of_other_widths_are_refused(write: Write) -> None:
    source, target = write("a.csv", "x,y,z", X), write("b.csv", "x,y,z", Y)
    normals = write("n.csv", "nx,ny,nz", N)
    good = normals.read_text("utf-8").splitlines()

    for line, words in (("1,2,up", "'up' is not a number"), ("1,2", "2 columns, not 3")):
        normals.write_text("\n".join([*good[:3], line, *good[4:]]), "utf-8")
        with pytest.raises(InvalidFileError, match=f"line 4: {words}"):
            _read(source, target, normals=normals)


def test_labels_of_springs_are_each_found_once(write: Write) -> None:
    source, target = write("a.csv", "x,y,z", X, NAMES), write("b.csv", "x,y,z", Y, NAMES)

    with pytest.raises(InvalidFileError, match="label 'a' comes twice"):
        _read(source, target, normals=write("n.csv", "nx,ny,nz", N, list("abcda")))
    with pytest.raises(InvalidFileError, match="no normals for the label 'e'"):
        _read(source, target, normals=write("n.csv", "nx,ny,nz", N, list("abcdf")))


def test_springs_of_the_source_are_refused_with_the_reason(write: Write) -> None:
    source = write("a.csv", "x,y,z,nx,ny,nz", np.column_stack([X, N]))
    target = write("b.csv", "x,y,z", Y)

    ways: list[dict[str, Any]] = [{"columns": ("plane",)}, {"files": {"normals": source}}]
    for given in ways:
        with pytest.raises(InvalidFileError, match="turn with the rotation that is sought"):
            read_problem(source, target, springs=SpringSource(**given))


def test_one_kind_comes_from_one_place_and_from_a_file_that_can_be_read(write: Write) -> None:
    source = write("a.csv", "x,y,z", X)
    target = write("b.csv", "x,y,z,nx,ny,nz", np.column_stack([Y, N]))

    with pytest.raises(InvalidFileError, match="by columns of the target, too"):
        _read(source, target, "plane", normals=target)
    with pytest.raises(InvalidFileError, match=r"from \.csv, .* with a header, \.npy, \.ply"):
        _read(source, target, normals=write("n.obj", "nx,ny,nz", N))
    with pytest.raises(InvalidFileError, match="standard input is read once"):
        _of_target("normals", source, "-")
    assert "nx" not in " ".join(_read(source, target, normals=target)[1].notes)


def test_one_kind_is_named_by_its_word(write: Write) -> None:
    source = write("a.csv", "x,y,z", X)
    target = write("b.csv", "x,y,z,nx,ny,nz", np.column_stack([Y, N]))

    assert certreg.read_problem(source, target, springs="plane")[0].digest() == PLANES.digest()
    with pytest.raises(InvalidProblemError, match="springs is 'planes': give one of plane, line"):
        certreg.read_problem(source, target, springs="planes")


def test_frozen_weights_are_told_of_whatever_brings_their_rows_in_order(write: Write) -> None:
    source, target = (
        write("a.csv", "x,y,z", X, NAMES),
        write("b.csv", "x,y,z", Y[BACK], NAMES[BACK]),
    )
    frozen = certreg.gicp_information(SPD[BACK], SPD[BACK], np.eye(3))

    problem, pair = stated_problem(source, target, information=frozen)

    back = certreg.RegistrationProblem(X, Y, information=np.asarray(frozen)[BACK])
    assert problem.digest() == back.digest()
    assert [note for note in pair.notes if "frozen at one rotation (R = I)" in note]


def test_the_command_says_what_is_wrong_in_one_line(write: Write) -> None:
    source, target = write("a.csv", "x,y,z", X), write("b.csv", "x,y,z", Y)

    run = commands.certreg("certify", source, target, "--springs", "plane")

    assert (run.code, run.out, run.err.count("\n")) == (2, "", 1)
    assert "names no normals: add columns nx,ny,nz" in run.err


PLY = """ply
format {order} 1.0
element vertex 5
property double x
property float nx
property double y
property double z
property float ny
property float nz
property uchar red
end_header
"""
PCD = """VERSION 0.7
FIELDS x y z normal_x normal_y normal_z curvature
SIZE 8 8 8 4 4 4 4
TYPE F F F F F F F
COUNT 1 1 1 1 1 1 1
WIDTH 5
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS 5
DATA {order}
"""
SHORT = N.astype(np.float32).astype(np.float64)
DOUBLE, SINGLE = "<f8", "<f4"
OF_PLY = np.dtype(f"{DOUBLE},{SINGLE},{DOUBLE},{DOUBLE},{SINGLE},{SINGLE},u1")
OF_PCD = np.dtype(",".join((*[DOUBLE] * 3, *[SINGLE] * 4)))


@pytest.mark.parametrize("order", ["ascii", "binary_little_endian"])
def test_vertices_of_ply_files_have_normals(write: Write, tmp_path: Path, order: str) -> None:
    columns = [Y[:, 0], SHORT[:, 0], Y[:, 1], Y[:, 2], SHORT[:, 1], SHORT[:, 2], np.full(5, 7)]
    rows = list(zip(*(column.tolist() for column in columns), strict=True))
    text = "".join(" ".join(f"{value!r}" for value in row) + "\n" for row in rows)
    body = (
        text.replace(" 7.0", " 7").encode()
        if order == "ascii"
        else np.array(rows, OF_PLY).tobytes()
    )
    target = tmp_path / "b.ply"
    target.write_bytes(PLY.format(order=order).encode() + body)
    source = write("a.csv", "x,y,z", X)

    problem, pair = _read(source, target, "plane")
    loaded = certreg.load(target)

    planes = certreg.RegistrationProblem(X, Y, normals=SHORT).digest()
    assert problem.digest() == planes
    assert pair.notes == [f"{target}: not used: red"]
    assert loaded.ignored == ("red",)
    assert certreg.RegistrationProblem(X, loaded, normals=loaded).digest() == planes
    with pytest.raises(InvalidFileError, match="has no covariances for its points: add cxx,cxy"):
        _read(source, target, "full")


@pytest.mark.parametrize("order", ["ascii", "binary"])
def test_points_of_pcd_files_have_normals(write: Write, tmp_path: Path, order: str) -> None:
    table = np.column_stack([Y, SHORT, np.zeros(5)])
    kind = np.dtype([(f"f{k}", "<f8" if k < 3 else "<f4") for k in range(7)])
    text = "".join(" ".join(map(repr, row)) + "\n" for row in table.tolist())
    body = (
        text.encode() if order == "ascii" else np.array([tuple(r) for r in table], kind).tobytes()
    )
    target = tmp_path / "b.pcd"
    target.write_bytes(PCD.format(order=order).encode() + body)

    problem, pair = _read(write("a.csv", "x,y,z", X), target, "plane")

    assert problem.digest() == certreg.RegistrationProblem(X, Y, normals=SHORT).digest()
    assert pair.notes == [f"{target}: not used: curvature"]
    assert (certreg.load(target).normals == SHORT).all()


def test_the_packaged_springs_are_planes(data: Path) -> None:
    lidar, pair = _read(data / "lidar_car_source.csv", data / "lidar_car_target.csv", "plane")
    form = data / "choi_lam_target.csv"
    choi_lam, other = _read(data / "choi_lam_source.csv", form, factors=form)

    for problem, n in ((lidar, 2500), (choi_lam, 68)):
        assert problem.springs is not None
        assert (problem.springs.kind, problem.springs.ranks) == ("plane", (0, n, 0, 0))
    assert (pair.notes, other.notes) == ([], [])
