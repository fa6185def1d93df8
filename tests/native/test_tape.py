"""Straight-line C, read and run by Python: each form of a statement, and what is none."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from certreg.native.kernels import GENERATED
from certreg.native.tape import Tape, tapes_of

FORM = """#include <math.h>

CERTREG_LINKAGE void certreg_trial(
    const CERTREG_REAL x[2],
    const CERTREG_REAL y[1],
    CERTREG_REAL first[3],
    CERTREG_REAL second[2])
{{
  CERTREG_REAL a0, a1, a2;
  a0=x[0];
  first[2]=a0;
  a1=x[1];
  a2=y[0];
{lines}  first[0]=a0;
  first[1]=a1;
  second[0]=a2;
  a0=CERTREG_CONSTANT(2.5000000000000000e-01);
  second[1]=a0;
}}
"""


def tape_of(*lines: str) -> Tape:
    """The function whose middle these statements are; it begins with a0, a1 = x and a2 = y."""
    ((name, tape),) = tapes_of(FORM.format(lines="".join(f"  {line}\n" for line in lines)))
    assert name == "certreg_trial"
    return tape


@pytest.mark.parametrize(
    ("line", "value"),
    [
        ("a0=(a0+a1);", 3.0 + 5.0),
        ("a0=(a0-a1);", 3.0 - 5.0),
        ("a0=(a0*a1);", 3.0 * 5.0),
        ("a0=(a0/a1);", 3.0 / 5.0),
        ("a0=(-a1);", -5.0),
        ("a0=CERTREG_SQRT(a1);", math.sqrt(5.0)),
        ("a0=CERTREG_CONSTANT(-2.);", -2.0),
    ],
)
def test_every_form_of_a_statement_has_its_value(line: str, value: float):
    tape = tape_of(line)
    rows: list[Any] = [np.array([[3.0, 3.0], [5.0, 5.0]]), np.array([[7.0, 7.0]])]

    assert tape.run([[3.0, 5.0], [7.0]]) == [[value, 5.0, 3.0], [7.0, 0.25]]
    assert np.array_equal(tape.run(rows)[0][0] + np.zeros(2), [value, value])


def test_a_name_stands_for_its_last_value_and_a_result_for_the_one_it_had():
    tape = tape_of("a1=(a0+a1);", "second[0]=a1;", "a1=(a1*a1);", "a2=(a1-a0);")

    assert tape.run([[3.0, 5.0], [7.0]]) == [[3.0, 64.0, 3.0], [61.0, 0.25]]
    assert len(tape.operations) == 3


def test_the_negative_of_zero_keeps_its_sign():
    ((first, _, _), _) = tape_of("a0=(-a0);").run([[0.0, 5.0], [7.0]])

    assert math.copysign(1.0, first) == -1.0


@pytest.mark.parametrize(
    "line", ["a0=fabs(a1);", "a0=(a0+a1)", "if (a0) a1=a0;", "a0=(a0%a1);", "a0=(a0+(a1*a2));"]
)
def test_what_is_no_such_statement_is_refused(line: str):
    with pytest.raises(ValueError, match="no statement of generated C"):
        tape_of(line)


def test_every_generated_function_is_read():
    for path in sorted(GENERATED.glob("*.c")):
        source = path.read_text("utf-8")
        tapes = dict(tapes_of(source))
        assert len(tapes) == source.count("CERTREG_LINKAGE void ") > 5
