"""The cones that CVXPY makes of the semidefinite programs, as a file of numbers for run time.

Written by `python -m derivations.emit`; certreg/relaxation/cones.py reads it.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from certreg.relaxation.cones import CONES_FILE
from certreg.relaxation.cvxpy_models import quartic_statement, statement
from certreg.relaxation.qcqp import RelaxationForm


def cone_files() -> dict[str, bytes]:
    """The contents of the file, by its name: a program on each line."""
    stated = {str(form): statement(form) for form in RelaxationForm}
    stated["quartic"] = quartic_statement()
    programs = {name: _numbers(each.problem, each.data) for name, each in stated.items()}
    lines = [f"{json.dumps(name)}: {json.dumps(each)}" for name, each in programs.items()]
    return {CONES_FILE: ("{\n" + ",\n".join(lines) + "\n}\n").encode()}


def _numbers(problem: Any, parameter: Any) -> dict[str, Any]:
    """What Clarabel is given; of the cost what each unit of the parameter makes of it.

    Raises ValueError where that is not all: where a constraint depends on the parameter, the cost
    is not linear in it, or another cone is there.
    """
    units = np.eye(parameter.size)
    given = [_data(problem, parameter, unit) for unit in units]
    first = given[0]
    rows = first["A"].toarray()
    cost = np.array([each["c"] for each in given]).T
    ramp = np.arange(1.0, parameter.size + 1)  # another value, that no unit is
    other = _data(problem, parameter, ramp)
    for each in (*given, other):
        if (each["A"] != first["A"]).nnz or not np.array_equal(each["b"], first["b"]):
            message = "a constraint depends on the parameter"
            raise ValueError(message)
    if not np.array_equal(other["c"], cost @ ramp):
        message = "the cost is not linear in the parameter"
        raise ValueError(message)
    dims = first["dims"]
    if "P" in first or len(rows) != dims.zero + sum(n * (n + 1) // 2 for n in dims.psd):
        message = "the program is not of equalities and one matrix alone"
        raise ValueError(message)
    (size,) = dims.psd
    return {
        "size": size,
        "equalities": dims.zero,
        "unknowns": rows.shape[1],
        "parameters": parameter.size,
        "right": [float(entry) + 0.0 for entry in first["b"]],
        "rows": _entries(rows),
        "cost": _entries(cost),
    }


def _data(problem: Any, parameter: Any, entries: Any) -> Any:
    parameter.value = entries.reshape(parameter.shape)
    return problem.get_problem_data("CLARABEL")[0]


def _entries(matrix: Any) -> list[Any]:
    """Row, column and value of what is not zero, by columns."""
    column, row = np.nonzero(matrix.T)
    return [row.tolist(), column.tolist(), matrix[row, column].tolist()]
