"""Writes what one checkout makes of the problems: a line of JSON for each, times left out.

    python tests/same/recorded.py CHECKOUT OUT [--part 0/2] [--quick]

Of certreg only public names are used, and the command that its pyproject.toml names: so any
checkout can be recorded, wherever its modules stand. It comes first on PYTHONPATH.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import enum
import hashlib
import io
import itertools
import json
import os
import sys
import tempfile
import tomllib
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

import numpy as np
from same.problems import problems

import certreg

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from same.problems import Problem

TIMES = {"timings_ms", "time_ms"}
OF_A_RUN = ("status", "steps", "escapes", "times", "states", "integrator")
FIELDS = {  # what is documented of results that have no `to_dict`
    "solve_many": ("quaternions", "translations", "rmse", "eigenvalues", "unstable", "margins"),
    "solve_many_springs": (
        *("outcomes", "quaternions", "translations", "energies", "counts", "indices", "stable"),
        "guarantee",
    ),
    "certify_many": ("poses", "gaps", "angles", "unique"),
    "simulate_many": OF_A_RUN,
    "breaking": ("complete", "least", "optimum_listed", "stable"),
}
FILES = ("weights", "normals", "directions", "covariances", "information", "factors")


class Recorder:
    """What a checkout makes of one problem, in a folder that is empty."""

    def __init__(self, checkout: Path, folder: Path) -> None:
        self.main = entry(checkout)
        self.folder = folder

    def record(self, problem: Problem) -> dict[str, Any]:
        """The document of a problem: for each public function what it gives, or its error."""
        if problem.call == "certify":
            return self._certified(problem)
        if problem.call == "batch":
            return {"batch": outcome(lambda: self._batch(problem))}
        if problem.call == "breaking":
            return _breaking(problem)
        return {problem.call: outcome(lambda: _stacked(problem))}

    def _certified(self, problem: Problem) -> dict[str, Any]:
        results = list[Any]()
        certified = outcome(lambda: _registration(problem, results))
        calls = {"register": _register, "command": self._command}
        if results:
            calls |= {"certificate": lambda _: _certificate(results[0].certificate)}
            calls |= {"verify": lambda given: _verify(given, results[0].certificate)}
        calls["assess"] = _assess
        if not problem.loss:
            calls |= {"equilibria": _equilibria, "simulate": _simulate}
        told = {name: outcome(lambda call=call: call(problem)) for name, call in calls.items()}
        return {"certify": certified, **told}

    def _command(self, problem: Problem) -> Any:
        """`certreg certify` on files: exit code, JSON, notes, and the certificate it writes."""
        if np.ndim(problem.statement.get("sigma", 0.0)):
            return "a noise for each pair goes by a column, not by an option"
        options = self._files(problem)
        out = self.folder / "out"
        told = self.run(
            *("certify", self.folder / "source.csv", self.folder / "target.csv", *options),
            *("--no-relaxation", "--no-simulation", "--json", "--out", out),
        )
        written = out / "certificate.json"
        proof = _of_file(written.read_bytes()) if written.exists() else None
        return {**told, "certificate": proof}

    def _files(self, problem: Problem) -> Iterator[Any]:
        """The clouds as files; then the options of the statement and of the loss."""
        for side in ("source", "target"):
            _write(self.folder / f"{side}.csv", getattr(problem, side))
        options = list[Any]()
        for name, value in {**problem.statement, **problem.loss}.items():
            option = f"--{name.replace('_', '-')}"
            if name in FILES:
                np.save(self.folder / f"{name}.npy", value)
                options += [option, self.folder / f"{name}.npy"]
            else:
                options += [option] if value is True else [option, value]
        return iter(options)

    def _batch(self, problem: Problem) -> Any:
        rows = ["source,target"]
        for k, clouds in enumerate(zip(problem.source, problem.target, strict=True)):
            for side, points in zip(("source", "target"), clouds, strict=True):
                _write(self.folder / f"{side}{k}.csv", points)
            rows.append(f"source{k}.csv,target{k}.csv")
        (self.folder / "list.csv").write_text("\n".join([*rows, ""]), "utf-8")
        return self.run("batch", self.folder / "list.csv")

    def run(self, *arguments: Any) -> dict[str, Any]:
        """A command in this process: its exit code and what it prints."""
        out, err = io.StringIO(), io.StringIO()
        code: Any = None
        with (
            mock.patch.object(sys, "argv", ["certreg", *map(str, arguments)]),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
        ):
            try:
                self.main()
            except SystemExit as stop:
                code = stop.code
        printed, told = (text.getvalue().replace(str(self.folder), "") for text in (out, err))
        return {"exit code": code, "stdout": _parsed(printed), "stderr": told}


# The calls ----------------------------------------------------------------------------------------


def _registration(problem: Problem, results: list[Any]) -> Any:
    """The first line and the JSON of a registration, which is kept in the list."""
    result = certreg.certify(
        problem.source, problem.target, **problem.statement, **problem.loss, **problem.options
    )
    results.append(result)
    return {"headline": str(result).partition("\n")[0], "document": result.to_dict()}


def _certificate(certificate: Any) -> Any:
    return None if certificate is None else _of_file(certificate.to_json())


def _of_file(content: str | bytes) -> dict[str, Any]:
    """The digests of a certificate as it is written, and of what it proves: all but `about`."""
    whole = content.encode() if isinstance(content, str) else content
    document = json.loads(whole)
    about = document.pop("about", None)
    proved = json.dumps(document, sort_keys=True).encode()
    return {
        "digest": hashlib.sha256(whole).hexdigest(),
        "digest without about": hashlib.sha256(proved).hexdigest(),
        "about": about,
        "kind": document.get("kind"),
    }


def _verify(problem: Problem, certificate: Any) -> Any:
    stated = None if problem.loss else _stated(problem)
    verdict = certreg.verify(certificate, stated)
    return {"ruling": verdict.ruling, "words": verdict.words, "theorems": verdict.theorems}


def _assess(problem: Problem) -> Any:
    """What is said of another tool's pose, or of its labels."""
    if problem.labels is None:
        found = certreg.assess(_stated(problem), problem.pose)
    else:
        found = certreg.assess(_stated(problem), labels=problem.labels, **problem.loss)
    return {"headline": str(found).partition("\n")[0], "document": found.to_dict()}


def _register(problem: Problem) -> Any:
    given = {key: value for key, value in problem.statement.items() if key != "damping"}
    if "sigma" in given and not given.keys() & {*FILES}:  # it takes the noise of springs alone
        given["weights"] = np.broadcast_to(given.pop("sigma") ** -2.0, len(problem.source))
    pose = certreg.register(problem.source, problem.target, **given)
    return {held.name: getattr(pose, held.name) for held in dataclasses.fields(pose)}


def _equilibria(problem: Problem) -> Any:
    return certreg.equilibria(_stated(problem)).to_dict()


def _simulate(problem: Problem) -> Any:
    found: Any = certreg.simulate(_stated(problem))
    return found.to_dict()


def _stated(problem: Problem) -> Any:
    return certreg.RegistrationProblem(problem.source, problem.target, **problem.statement)


def _stacked(problem: Problem) -> Any:
    """What is found of many problems at once."""
    clouds, springs = (problem.source, problem.target), problem.options
    if problem.call == "simulate_many":
        bodies = certreg.bodies_on_springs(*clouds, **springs)
        found: Any = certreg.simulate_many(bodies)
    else:
        found = getattr(certreg, problem.call)(*clouds, **springs)
    told = {name: getattr(found, name) for name in FIELDS[problem.call]}
    if problem.call == "certify_many":
        told["certificates"] = [_certificate(found[k]) for k in range(len(problem.source))]
    return told


def _breaking(problem: Problem) -> dict[str, Any]:
    """Springs that break beyond their bounds: where they rest, and the motion."""

    def rest() -> Any:
        found = certreg.breaking_equilibria(problem.source, problem.target, **problem.loss)
        return {name: getattr(found, name) for name in FIELDS["breaking"]}

    def motion() -> Any:
        found = certreg.simulate_breaking(problem.source, problem.target, **problem.loss)
        fields = ("rotation", "translation", "unbroken", "self_consistent", "ending")
        return {name: getattr(found, name) for name in fields}

    return {"breaking_equilibria": outcome(rest), "simulate_breaking": outcome(motion)}


# What is kept -------------------------------------------------------------------------------------


def outcome(call: Callable[[], Any]) -> Any:
    """What a call gives, as JSON has it, or its error: a refusal is part of what users see."""
    try:
        return plain(call())
    except Exception as error:  # noqa: BLE001 (a traceback, too, is part of the record)
        return {"error": type(error).__name__, "message": str(error)}


def plain(value: Any) -> Any:
    """A value as JSON has it, without times; of what JSON does not have, its parts or its type."""
    if isinstance(value, np.ndarray | np.generic):
        pair = [value.real.tolist(), value.imag.tolist()]
        return plain(pair if np.iscomplexobj(value) else value.tolist())
    if isinstance(value, enum.Enum):
        return plain(value.value)
    if isinstance(value, dict):
        return {str(key): plain(part) for key, part in value.items() if key not in TIMES}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {part.name: plain(getattr(value, part.name)) for part in dataclasses.fields(value)}
    return value if isinstance(value, str | float | int | None) else type(value).__name__


def _parsed(printed: str) -> Any:
    """What was printed, as JSON where each line, or the whole, is."""
    with contextlib.suppress(ValueError):
        return plain(json.loads(printed))
    with contextlib.suppress(ValueError):
        return [plain(json.loads(line)) for line in printed.splitlines()]
    return printed


def _write(path: Path, points: Any) -> None:
    path.write_text("".join(f"{','.join(map(repr, row))}\n" for row in points.tolist()), "utf-8")


def entry(checkout: Path) -> Callable[[], Any]:
    """What the command `certreg` of a checkout calls, as its pyproject.toml says."""
    with (checkout / "pyproject.toml").open("rb") as stream:
        module, name = tomllib.load(stream)["project"]["scripts"]["certreg"].split(":")
    return getattr(import_module(module), name)


def main() -> None:
    parser = argparse.ArgumentParser(description="What a checkout makes of the problems.")
    parser.add_argument("checkout", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--part", default="0/1")
    parser.add_argument("--quick", action="store_true")
    asked = parser.parse_args()
    imported = Path(certreg.__path__[0]).resolve().parent
    if imported != asked.checkout.resolve():
        sys.exit(f"certreg was imported from {imported}, not from {asked.checkout}")
    part, parts = map(int, asked.part.split("/"))
    with asked.out.open("w", encoding="utf-8") as stream:
        for name, problem in itertools.islice(problems(quick=asked.quick), part, None, parts):
            with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
                told = Recorder(asked.checkout, Path(folder)).record(problem)
            stream.write(json.dumps([name, told]) + "\n")


if __name__ == "__main__":
    os.environ["COLUMNS"] = "80"
    main()
