"""The light net: what small cases print and write, in this process, beside committed records.

    python tests/golden/net.py [NAME ...]    renews the records, or those of the cases named

A record is a text: each step, its exit code, what it printed, and the files that it names. Times,
versions and what a page's script is are left out; numbers are compared as numbers. A record that
still holds is not written anew, so that the noise of another machine changes no file.
"""

from __future__ import annotations

import base64
import contextlib
import difflib
import importlib.metadata
import io
import json
import math
import os
import re
import shlex
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest import mock

import net_inputs
import net_inside
import net_python
import net_shown
import numpy as np
from campaign_work import InProcess
from commands import certreg
from net_cases import CASES
from volatile import stable_name, stable_text

import build_kernels
import certreg as package

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from net_cases import NetCase

RECORDS = Path(__file__).with_name("records")
TEMPLATES = Path(package.__file__).parent / "report" / "templates"
RELATIVE = 1e-6  # of numbers: a library of linear algebra changes the last digits
FLOOR = 1e-7  # below it two numbers are rounding; a root of it, as of a double eigenvalue, is 3e-8
SOLVER = re.compile(r'SDP|semidefinite|"(?:sdp_gap|nu|value|proved_gap)"|rotation alone')
DYADIC = {"gap", "sdp_gap", "sin2_half_angle", "delta", "mu", "nu", "angular_velocity"}
LOOSE = 1.0  # as FLOOR, on a line of what a solver proposes: it ends where it is near enough
DIGITS = 9  # of numbers of JSON that are kept
SHORT = 100  # characters of JSON on one line
MANY = 12  # numbers: of more their count, sum and sum of squares stand in the record
SHOWN = 40  # lines of a difference
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?!\w)")
PATH = re.compile(r'(?<=[ "])[A-Z](?=[-\d.])')  # a letter of SVG before its numbers
SCRIPT = re.compile(r'(?s)<script(?! id="scene")[^>]*>.*?</script>|<style>.*?</style>')
STYLE = re.compile(
    r' style="(?:(?!color:#)[^"])*"'
)  # of a card: where it does not colour a headline
SCENE = re.compile(r'(?s)<script id="scene"[^>]*>(.*?)</script>')
# Of general springs: where a solver's dual ends changes with its library of linear algebra, and so
# does what rests on the growth that it proves. Which optimum of many is told changes, too.
OF_DUAL = re.compile(
    r'(?m)"(?:mu|radius_target|radius_both|angle_to_pose_deg|relaxation_deg)": [^,}\n]*'
    r'|^  "value": .*'
    r"|(?:every target point is|every point of both clouds is|as every target point is) off by less"
    r" than \S+|points of both clouds, \S+|costs at least \S+"
)
OF_MANY = re.compile(
    r"(?m)^ *(?:rotation \(wxyz\)|translation|the optimum: wxyz|its translation|above the minimum"
    r"|proved gap) .*|<dt>(?:Rotation|Axis|Translation|Gap)</dt>.*"
    r"|(?:by|NEAR-OPTIMAL:) at most \S+.*|^The (?:certified rotation|objective at) R .*"
    r"|^So the minimum is .*|source's axis \([^)]*\)"
)


# Running ------------------------------------------------------------------------------------------


def recorded(case: NetCase) -> str:
    """What the steps of a case print and write."""
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.chdir(folder),
        mock.patch.dict(os.environ, COLUMNS="80"),
        _workers(),
    ):
        net_inputs.write(case.steps)
        return without_ends(case.name, "\n".join(_step(step) for step in case.steps))


def without_ends(name: str, text: str) -> str:
    """The record of a case without numbers that are where a solver ends."""
    for begun, pattern in (("springs-", OF_DUAL), ("springs-free", OF_MANY)):
        if name.startswith(begun):
            text = pattern.sub(lambda found: NUMBER.sub("*", found[0]), text)
    return text


def _workers() -> contextlib.AbstractContextManager[Any]:
    """A list of pairs is worked on by a thread of this process: a new one takes a second."""
    return mock.patch("certreg.cli.campaigns.workers_at", side_effect=lambda _: InProcess(1))


def _step(step: str) -> str:
    name, *arguments = shlex.split(step)
    if name == "file":
        return "".join(_file(Path(each)) for each in arguments)
    if name == "page":
        text = Path(arguments[0]).read_text("utf-8")
        return f"=== {step}\n{net_python.sentences_of(page(text))}\n"
    if name == "python":
        steps = {**net_inside.STEPS, **net_shown.STEPS}
        call = steps.get(arguments[0]) or getattr(net_python, arguments[0])
        text = call(*arguments[1:])
        return f"$ {step}\n{canonical(STYLE.sub('', text))}\n"
    run = certreg(name, *arguments)
    if name == "info":
        return f"$ info\n{' '.join(line.split()[0] for line in run.out.splitlines())}\n"
    told = f"$ {step}\nexit code {run.code}\n{canonical(run.out)}"
    return f"{told}--- stderr\n{canonical(run.err)}" if run.err else told


def _file(path: Path) -> str:
    """A file, or the names in a folder."""
    if path.is_dir():
        names = sorted(stable_name(each.name) for each in path.iterdir())
        return f"=== {path}/: {' '.join(names)}\n"
    if not path.exists():
        return f"=== {path}: not there\n"
    content = path.read_bytes()
    return f"=== {path}\n{_content(path.suffix, content)}\n"


def _content(suffix: str, content: bytes) -> str:
    if suffix == ".npz":
        with np.load(io.BytesIO(content)) as held:
            return "\n".join(f"{name} {_of_array(held[name])}" for name in held.files)
    if suffix == ".npy":
        return str(np.load(io.BytesIO(content)).tolist())
    try:
        text = content.decode()
    except UnicodeDecodeError:
        head, _, body = content.partition(b"end_header\n")  # a .ply file of doubles
        return f"{canonical(head.decode())}{np.frombuffer(body, '<f8').tolist()}"
    return page(text) if suffix == ".html" else canonical(text)


def _of_array(array: Any) -> str:
    kind = f"{array.dtype} {array.shape}"
    return f"{kind} {_sums(array.ravel().tolist())}" if array.dtype.kind in "fi" else kind


# What is kept -------------------------------------------------------------------------------------


def canonical(text: str) -> str:
    """A text without times and versions, its JSON in short lines."""
    text = stable_text(text, {str(package.__path__[0]): "PACKAGE", str(Path.cwd()): "FOLDER"})
    for version in sorted(_versions(), key=len, reverse=True):
        if version in text:
            text = re.sub(rf"(?<![\w.]){re.escape(version)}(?!\w|\.\d)", "VERSION", text)
    if text.startswith("{\n"):
        document = json.loads(text)
        return f"{_laid_out(_evaluated(document) if 'format' in document else document)}\n"
    lines = (_line(line) for line in text.split("\n"))
    return "\n".join(lines)


@cache
def _versions() -> frozenset[str]:
    """Of certreg and what it runs on: with two dots, as no number has them."""
    found = (each.version for each in importlib.metadata.distributions())
    return frozenset(each for each in (*found, package.__version__) if each.count(".") > 1)


def _line(line: str) -> str:
    if not line.startswith('{"'):
        return line.rstrip()
    with contextlib.suppress(ValueError):
        return _laid_out(json.loads(line))
    return line


def _evaluated(certificate: Any) -> Any:
    """A certificate with what its dyadic numbers are, and unit quaternions: not how they are cut.

    A mantissa may have a bit more on another machine, where a solver ends elsewhere.
    """
    for part in (certificate.get(name) or {} for name in ("claims", "optimality", "sdp", "basin")):
        given: dict[str, Any] = part
        for name, value in given.items():
            if value is None:
                continue
            if name in DYADIC:
                *mantissas, exponent = value
                part[name] = [math.ldexp(mantissa, exponent) for mantissa in mantissas]
            elif name == "quaternion":
                norm = math.hypot(*value)
                part[name] = [entry / norm for entry in value]
    return certificate


def _laid_out(value: Any, indent: str = "") -> str:
    """JSON: an object of more than a line by its fields, a list of numbers on one line."""
    short = json.dumps(_rounded(value), ensure_ascii=False)
    nested = isinstance(value, dict | list) and "{" in short
    if (not nested and not isinstance(value, dict)) or len(short) <= SHORT:
        return short
    inner = f"{indent} "
    if isinstance(value, list):
        parts = [_laid_out(each, inner) for each in value]
        return f"[\n{inner}" + f",\n{inner}".join(parts) + f"\n{indent}]"
    parts = _invariant(value).items()
    fields = [f"{json.dumps(key)}: {_laid_out(each, inner)}" for key, each in parts]
    return f"{{\n{inner}" + f",\n{inner}".join(fields) + f"\n{indent}}}"


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    if isinstance(value, dict):
        return {key: _rounded(each) for key, each in _invariant(value).items()}
    return value


def _invariant(fields: dict[str, Any]) -> dict[str, Any]:
    """A component of many equilibria without the basis that was chosen: its projector's diagonal.

    A direction chosen within it is that of the basis, and left out.
    """
    if not fields.get("dimension"):
        return fields
    basis = np.array(fields["basis"])
    squares = (basis**2).sum(axis=0 if basis.shape[-1] == 4 else 1)
    return fields | {"basis": squares.tolist()} | ({"witness": None} if "witness" in fields else {})


def page(text: str) -> str:
    """What is not the same on every page: its lines that are not the template's, and its data."""
    whole = text.startswith("<!doctype")
    body = SCRIPT.sub("", text[text.index("<title>") :] if whole else text)
    body = STYLE.sub("", body)
    body = SCENE.sub(lambda found: _laid_out(_drawn(json.loads(found[1]))), body)
    lines = (line for line in body.split("\n") if line.strip() and line not in _fixed())
    return canonical("\n".join(PATH.sub(r"\g<0> ", line) for line in lines))


@cache
def _fixed() -> frozenset[str]:
    """Lines of the templates that are on every page as they are."""
    texts = (path.read_text("utf-8") for path in TEMPLATES.glob("*.html"))
    return frozenset(line for text in texts for line in text.split("\n"))


def _drawn(value: Any) -> Any:
    """The data of a page's script: of many numbers their sums."""
    if isinstance(value, dict):
        return {key: _drawn(each) for key, each in value.items()}
    if isinstance(value, list):
        numbers = len(value) > MANY and all(isinstance(each, int | float) for each in value)
        return _sums(value) if numbers else [_drawn(each) for each in value]
    if isinstance(value, str) and len(value) > SHORT and re.fullmatch(r"[\w+/=]+", value):
        return _sums(np.frombuffer(base64.b64decode(value), dtype="<f4").astype(float).tolist())
    return value


def _sums(values: Sequence[float]) -> str:
    finite = [each for each in values if math.isfinite(each)]
    squares = math.fsum(each * each for each in finite)
    return f"{len(values)} numbers, sum {math.fsum(finite):.7g}, of squares {squares:.7g}"


# Comparing ----------------------------------------------------------------------------------------


def difference(old: str, new: str) -> list[str]:
    """The lines that differ, with - and +, those around them with a blank; empty where none do."""
    first, second = old.splitlines(), new.splitlines()
    matched = difflib.SequenceMatcher(
        None, [_frame(line) for line in first], [_frame(line) for line in second], autojunk=False
    )
    lines = list[str]()
    for kind, i, j, k, m in matched.get_opcodes():
        if kind != "equal":
            lines += [f"-{line}" for line in first[i:j]] + [f"+{line}" for line in second[k:m]]
            continue
        for one, other in zip(first[i:j], second[k:m], strict=True):
            near = same_numbers(one, other)
            lines += [f" {one}"] if near else [f"-{one}", f"+{other}"]
    return _near_changes(lines)


def _frame(line: str) -> str:
    """A line without its numbers; a column that they widen is the same column."""
    return re.sub(r"(?<=\S) +", " ", NUMBER.sub("#", line)).rstrip()


def same_numbers(one: str, other: str) -> bool:
    """Whether the numbers of two lines are the same but for rounding."""
    pairs = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
    floor = LOOSE if SOLVER.search(one) else FLOOR
    return all(_same(float(a), float(b), floor) for a, b in pairs)


def _same(a: float, b: float, floor: float) -> bool:
    large = max(abs(a), abs(b))
    return a == b or abs(a - b) <= RELATIVE * large or large <= floor


def _near_changes(lines: list[str]) -> list[str]:
    """Changed lines with two on either side."""
    changed = [k for k, line in enumerate(lines) if line[0] in "-+"]
    kept = {k for c in changed for k in range(c - 2, c + 3) if 0 <= k < len(lines)}
    shown = [lines[k] for k in sorted(kept)]
    more = len(shown) - SHOWN
    return shown[:SHOWN] + ([f"... and {more} more lines"] if more > 0 else [])


# Renewing -----------------------------------------------------------------------------------------


def record_of(name: str) -> Path:
    return RECORDS / f"{name}.txt"


def renew(names: Sequence[str]) -> Iterator[str]:
    """Write the records that do not hold any more; in a line each, what was done."""
    RECORDS.mkdir(exist_ok=True)
    for case in CASES:
        if names and case.name not in names:
            continue
        path, text = record_of(case.name), recorded(case)
        if path.exists() and not difference(path.read_text("utf-8"), text):
            continue
        yield f"{case.name}: {'renewed' if path.exists() else 'new'}"
        path.write_text(text, "utf-8")
    known = {record_of(case.name) for case in CASES}
    for path in set(RECORDS.glob("*.txt")) - known:
        path.unlink()
        yield f"{path.stem}: removed"


if __name__ == "__main__":
    build_kernels.renewed(set_up=False)
    for told in renew(sys.argv[1:]):
        sys.stdout.write(f"{told}\n")
