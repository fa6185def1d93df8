"""Bad input for the command line: files, options, and what the one line on stderr must say.

Data alone: the tests of the present code read it, and the golden record, whatever code it runs.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

POINTS = [[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]
ARRAY = np.array(POINTS)
CSV = b"0,0,0\n1,0,0\n0,2,0\n0,0,3\n"
LABELLED = b"label,x,y,z\na,0,0,0\nb,1,0,0\nc,0,2,0\nd,0,0,3\n"


def npy(array: Any, **options: Any) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.asarray(array), **options)
    return buffer.getvalue()


def point(value: float, row: int = 2) -> np.ndarray:
    array = ARRAY.copy()
    array[row, 1] = value
    return array


@dataclass(frozen=True)
class Bad:
    """Files to write, and what the one line on stderr must say.

    The clouds are the files named source.* and target.*, else good ones.
    """

    files: dict[str, bytes]
    says: tuple[str, ...]
    options: tuple[str, ...] = ()
    arguments: tuple[str, ...] = field(default=())  # instead of source and target


def weighted(content: bytes, *says: str, name: str = "w.txt") -> Bad:
    return Bad({name: content}, (name, *says), ("--weights", f"{{tmp}}/{name}"))


BAD = {
    # files that are not there, or nothing of the kind
    "missing file": Bad({}, ("nowhere.csv",), arguments=("nowhere.csv", "target.csv")),
    "missing npy": Bad({}, ("nowhere.npy",), arguments=("nowhere.npy", "target.csv")),
    "missing target": Bad({}, ("nowhere.txt",), arguments=("source.csv", "nowhere.txt")),
    "wrong extension": Bad({"source.doc": CSV}, ("source.doc", ".csv .txt .xyz .asc")),
    "no extension": Bad({"source": CSV}, ("source", ".csv .txt .xyz .asc")),
    "empty file": Bad({"source.csv": b""}, ("source.csv",)),
    "empty txt": Bad({"source.txt": b""}, ("source.txt",)),
    "empty npy": Bad({"source.npy": b""}, ("source.npy", "numpy.save")),
    "header only": Bad({"source.csv": b"x,y,z\n"}, ("source.csv", "line 1", "no points")),
    "comments only": Bad({"source.txt": b"# x y z\n"}, ("source.txt",)),
    # text
    "binary junk as csv": Bad({"source.csv": bytes(range(256))}, ("source.csv", "line 1")),
    "latin-1": Bad({"source.csv": b"label,x,y,z\n\xe4,1,2,3\n"}, ("source.csv", "line 2", "utf-8")),
    "UTF-16": Bad({"source.csv": CSV.decode().encode("utf-16")}, ("source.csv", "line 1", "utf-8")),
    "a word": Bad({"source.csv": CSV + b"1,two,3\n"}, ("source.csv", "line 5", "'two'")),
    "NaN": Bad({"source.csv": CSV + b"1,nan,3\n"}, ("source.csv", "line 5", "'nan'")),
    "infinity": Bad({"target.txt": CSV + b"1,-inf,3\n"}, ("target.txt", "line 5", "'-inf'")),
    "beyond the doubles": Bad(
        {"source.csv": CSV + b"1,1e999,3\n"}, ("source.csv", "line 5", "1e999")
    ),
    "underscores": Bad({"source.csv": CSV + b"1,1_000,3\n"}, ("source.csv", "line 5", "1_000")),
    "decimal commas": Bad(
        {"source.csv": b"1;2,345;3\n4;5;6\n"}, ("source.csv", "line 1", "is it 2.345 or 2345?")
    ),
    "two columns": Bad({"source.csv": b"1,2\n3,4\n"}, ("source.csv", "line 1", "three columns")),
    "a short row": Bad({"source.csv": CSV + b"1,2\n"}, ("source.csv", "line 5", "2 columns")),
    "a long row": Bad({"source.csv": CSV + b"1,2,3,4\n"}, ("source.csv", "line 5", "4 columns")),
    "no x": Bad({"source.csv": b"a,y,z\n1,2,3\n"}, ("source.csv", "line 1", "x, y")),
    "x twice": Bad({"source.csv": b"x,x,y,z\n1,1,2,3\n"}, ("source.csv", "line 1", "x, y")),
    "an open quote": Bad({"source.csv": CSV + b'1,"2,3\n'}, ("source.csv", "line 5")),
    "text behind a quote": Bad({"source.csv": CSV + b'1,"2"5,3\n'}, ("source.csv", "line 5")),
    # correspondence
    "another number of rows": Bad(
        {"target.csv": CSV + b"1,1,1\n"}, ("source.csv has 4", "target.csv has 5", "same number")
    ),
    "an unmatched label": Bad(
        {"source.csv": LABELLED, "target.csv": LABELLED.replace(b"c", b"e")}, ("'c'", "target")
    ),
    "a duplicate label": Bad(
        {"source.csv": LABELLED, "target.csv": LABELLED.replace(b"c", b"b")}, ("'b'", "2 times")
    ),
    "a label too many": Bad(
        {"source.csv": LABELLED, "target.csv": LABELLED + b"e,1,1,1\n"}, ("'e'", "source")
    ),
    "a label that paints the terminal": Bad(
        {"source.csv": LABELLED, "target.csv": LABELLED.replace(b"c,", b"\x1b[31mc,")}, ("target",)
    ),
    # npy
    "truncated npy": Bad(
        {"source.npy": npy(ARRAY)[:-1]}, ("source.npy", "declares 96", "holds 95")
    ),
    "npy cut in its header": Bad({"source.npy": npy(ARRAY)[:40]}, ("source.npy", "numpy.save")),
    "npy that declares more": Bad(
        {"source.npy": npy(ARRAY).replace(b"(4, 3), }  ", b"(400, 3), }")}, ("source.npy", "9600")
    ),
    "npy with something behind": Bad(
        {"source.npy": npy(ARRAY) + b"\0"}, ("source.npy", "holds 97")
    ),
    "junk as npy": Bad({"source.npy": bytes(range(256))}, ("source.npy", "numpy.save")),
    "text as npy": Bad({"source.npy": CSV}, ("source.npy", "numpy.save")),
    "pickle": Bad(
        {"source.npy": npy(ARRAY.astype(object), allow_pickle=True)}, ("source.npy", "object")
    ),
    "complex npy": Bad({"source.npy": npy(ARRAY + 0j)}, ("source.npy", "complex128", "float64")),
    "boolean npy": Bad({"source.npy": npy(ARRAY > 0)}, ("source.npy", "bool", "float64")),
    "npy of text": Bad({"source.npy": npy(ARRAY.astype(str))}, ("source.npy", "float64")),
    "transposed npy": Bad({"source.npy": npy(ARRAY.T)}, ("source.npy", "(3, 4)", "(N, 3)")),
    "npy without points": Bad({"source.npy": npy(ARRAY[:0])}, ("source.npy", "(0, 3)", "N >= 1")),
    "npy of one number": Bad({"source.npy": npy(1.0)}, ("source.npy", "()", "(N, 3)")),
    "npy with NaN": Bad({"source.npy": npy(point(math.nan))}, ("source.npy", "row 2", "finite")),
    "npy with infinity": Bad(
        {"target.npy": npy(point(-math.inf))}, ("target.npy", "row 2", "finite")
    ),
    "npy of large integers": Bad(
        {"source.npy": npy(ARRAY.astype(int) + 2**53 + 1)}, ("source.npy", "row 0", "double")
    ),
    "npy of the largest integer": Bad(
        {"source.npy": npy(np.full((4, 3), 2**63 - 1))}, ("source.npy", "row 0", "double")
    ),
    # weights, noise, damping
    "zero weights": weighted(b"0\n0\n0\n0\n", "all weights are zero"),
    "a negative weight": weighted(b"1\n1\n-1\n1\n", "weight 2", ">= 0"),
    "too few weights": weighted(b"1\n1\n1\n", "3 weights", "4 points"),
    "a word as weight": weighted(b"1\none\n1\n1\n", "line 2", "'one'"),
    "two weights a line": weighted(b"1 1\n1 1\n", "line 1"),
    "no weights": weighted(b"", "no weights"),
    "weights of NaN": weighted(b"1\nnan\n1\n1\n", "line 2", "'nan'"),
    "npy weights of NaN": weighted(npy([1, math.nan, 1, 1]), "row 1", "finite", name="w.npy"),
    "npy weights in a column": weighted(npy([[1.0]] * 4), "(4, 1)", "(N,)", name="w.npy"),
    "negative npy weights": weighted(npy([1.0, 1, 1, -3]), "weight 3", ">= 0", name="w.npy"),
    "missing weights": Bad({}, ("w.csv",), ("--weights", "{tmp}/w.csv")),
    "sigma of 0": Bad({}, ("sigma", "> 0"), ("--sigma", "0")),
    "negative sigma": Bad({}, ("sigma", "> 0"), ("--sigma", "-1")),
    "sigma of NaN": Bad({}, ("sigma", "finite"), ("--sigma", "nan")),
    "sigma of infinity": Bad({}, ("sigma", "finite"), ("--sigma", "inf")),
    "sigma of 1e-170": Bad({}, ("sigma", "unit of length"), ("--sigma", "1e-170")),
    "sigma of 1e200": Bad({}, ("sigma", "unit of length"), ("--sigma", "1e200")),
    "damping of 0": Bad({}, ("damping", "positive"), ("--damping", "0")),
    "negative damping": Bad({}, ("damping", "positive"), ("--damping", "-2")),
    "damping of NaN": Bad({}, ("damping", "positive"), ("--damping", "nan")),
    # places that cannot be written
    "a file as parent folder": Bad(
        {"file": b"kept"}, ("file", "choose another place"), ("--out", "{tmp}/file/out")
    ),
}

USAGE = {
    "a word for sigma": (("--sigma", "abc"), "'--sigma': 'abc'"),
    "nothing for sigma": (("--sigma",), "'--sigma'"),
    "a word for damping": (("--damping", "1,5"), "'--damping': '1,5'"),
    "an unknown option": (("--frobnicate",), "--frobnicate"),
    "a third cloud": (("third.csv",), "third.csv"),
    "sigma and weights": (("--sigma", "1", "--weights", "w.txt"), "exclude each other"),
    "a folder for weights": (("--weights", "{tmp}"), "is a directory"),
    "a file for a folder": (("--out", "{tmp}/source.csv"), "is a file"),
}
