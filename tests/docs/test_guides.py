"""What the guides tell the reader to type works, and prints what they say."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from engines import c_compiler

import certreg
from certreg.native.engine import evaluator
from certreg.results import PoseVerdict

ROOT = Path(__file__).parents[2]
NAMES = (
    "embed-the-c-code",
    "simulate",
    "springs-that-break",
    "wrong-pairs",
    "many-problems",
    "cluster",
    "coming-from",
    "another-problem",
    "icp",
)
DOCS = ROOT / "docs"
GUIDES = [DOCS / "howto" / f"{name}.md" for name in NAMES]
FENCE = re.compile(r"^```(?:\{code-cell\} )?(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
SCRATCH = re.compile(r"^```\{scratch\} (\S+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
each_guide = pytest.mark.parametrize("guide", GUIDES, ids=lambda path: path.stem)


def blocks(guide: Path, language: str) -> list[str]:
    return [body for found, body in FENCE.findall(guide.read_text("utf-8")) if found == language]


PRIVATE = re.compile(
    r"^\s*(?:from|import) certreg[\w.]*(?:\._| import (?:.*[ ,(])?_)\w+", re.MULTILINE
)


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=lambda path: path.stem)
def test_no_page_imports_a_name_that_is_private_to_a_module(page: Path):
    assert PRIVATE.findall(page.read_text("utf-8")) == []


def test_an_import_of_a_private_name_is_seen():
    text = """
from certreg.exact.balls import box, _radius
from certreg import _loading
import certreg._loading
from certreg.geometry.so3 import body_frame
"""

    assert len(PRIVATE.findall(text)) == 3


TAUGHT = [ROOT / "README.md", DOCS / "index.md", DOCS / "tutorial.md"]
TAUGHT += [*DOCS.glob("tutorials/*.md"), *DOCS.glob("howto/*.md")]
IMPORT = re.compile(r"^\s*(?:from (certreg[\w.]*) import|import (certreg[\w.]*))", re.MULTILINE)
WORDS = re.compile(r"\bcertreg(?:\.\w+)+")


def imported(text: str) -> list[str]:
    """The modules of certreg that the code of a page imports."""
    return [source or module for source, module in IMPORT.findall(text)]


@pytest.mark.parametrize("page", TAUGHT, ids=lambda path: path.stem)
def test_a_guide_teaches_public_names_only(page):
    text = page.read_text("utf-8")
    code = "\n".join(body for language, body in FENCE.findall(text) if language != "sh")
    names = {word.split(".")[1] for word in WORDS.findall(code)}

    assert set(imported(text)) <= {"certreg"}
    assert names <= set(certreg.__all__), names - set(certreg.__all__)


def test_there_are_guides():
    assert {path.stem for path in GUIDES} >= {"embed-the-c-code", "simulate"}


@pytest.mark.slow
@pytest.mark.one_in(3)
@each_guide
def test_the_python_of_a_guide_runs(guide, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where the files are that it writes
    namespace: dict[str, object] = {}
    written = blocks(guide, "python")
    for block in written:
        exec(compile(block, guide.name, "exec"), namespace)  # noqa: S102 - our own page

    assert len(written) == guide.read_text("utf-8").count("```python")  # none is passed over
    assert bool(written) == bool(namespace)


def test_open3d_is_judged_as_the_guide_says():
    """Where it is installed: its block goes on from that of SciPy."""
    pytest.importorskip("open3d", reason="no peer is installed: `make peers`")
    page = DOCS / "howto" / "coming-from.md"
    namespace: dict[str, object] = {}
    for block in (*blocks(page, "python"), *blocks(page, "py")):
        exec(compile(block, page.name, "exec"), namespace)  # noqa: S102 - our own page

    judged = certreg.assess(namespace["problem"], namespace["T"])  # pyright: ignore[reportArgumentType]
    assert judged.verdict in {PoseVerdict.OPTIMAL, PoseVerdict.NEAR_OPTIMAL}


def scratch(page: Path) -> dict[str, str]:
    """The files that a page writes before its commands."""
    return dict(SCRATCH.findall(page.read_text("utf-8")))


def test_open3d_finds_the_pairs_that_the_guide_shows(tmp_path, monkeypatch):
    """Many to one; the pose to the last digits, in which processors may differ."""
    page = DOCS / "howto" / "icp.md"
    files = scratch(page)
    assert set(files) == {"source.xyz", "target.xyz", "pairs.txt", "pose.txt"}
    pytest.importorskip("open3d", reason="no peer is installed: `make peers`")
    for name in ("source.xyz", "target.xyz"):
        (tmp_path / name).write_text(files[name], "utf-8")
    monkeypatch.chdir(tmp_path)
    (block,) = blocks(page, "py")
    exec(compile(block, page.name, "exec"), {})  # noqa: S102 - our own page

    assert (tmp_path / "pairs.txt").read_text("utf-8") == files["pairs.txt"]
    shown, made = (
        np.loadtxt(text.splitlines())
        for text in (files["pose.txt"], (tmp_path / "pose.txt").read_text("utf-8"))
    )
    assert made == pytest.approx(shown, abs=1e-12)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


# Four processes that load dask; tests/campaign runs a cluster of two workers every time.
LONG = {"cluster"}
WITH_COMMANDS = [
    pytest.param(guide, id=guide.stem, marks=[pytest.mark.long] if guide.stem in LONG else [])
    for guide in GUIDES
]


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("guide", WITH_COMMANDS)
def test_the_commands_of_a_guide_run(guide, tmp_path, data):
    """`certreg` is this checkout's; the shell stops at the first command that fails."""
    c_compiler()
    if guide.stem == "cluster":
        pytest.importorskip("distributed", reason="the extra `campaign` is not installed")
    for name in ("survey_source.csv", "survey_target.csv"):
        shutil.copy(data / name, tmp_path)
    (tmp_path / "bin").mkdir()
    for name in ("certreg", "dask"):
        command = tmp_path / "bin" / name
        command.write_text(f'#!/bin/sh\nexec {sys.executable} -m {name} "$@"\n', "utf-8")
        command.chmod(0o755)
    changed = {"PATH": f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"}
    if guide.stem == "cluster":  # Dask itself reads files in the encoding of the machine
        changed["PYTHONWARNDEFAULTENCODING"] = ""

    run = subprocess.run(
        ["sh", "-e"],
        input="\n".join(blocks(guide, "sh")).replace("8786", str(free_port())),
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **changed, "PYTHONPATH": str(ROOT)},
        encoding="utf-8",
    )

    assert (run.returncode, run.stderr) == (0, "")
    if guide.stem == "cluster":
        assert "2 of 2 pairs registered: results/results.jsonl" in run.stdout
        assert len(list((tmp_path / "results" / "certificates").iterdir())) == 2
    if guide.stem == "embed-the-c-code":
        assert run.stdout.split()[-1] == "2346"
        assert {"dynamics.c", "dynamics.h", "example.c", "survey.txt"} <= set(run.stdout.split())


@pytest.mark.slow
def test_the_vectors_of_the_guide_compile_and_step(tmp_path):
    """Eight lanes of the guide's own code, each as `certreg_euler_step` does it alone."""
    guide = ROOT / "docs" / "howto" / "embed-the-c-code.md"
    lanes = next(block for block in blocks(guide, "c") if "vector_size" in block)
    compiler = c_compiler()
    main = """
    #include <stdio.h>
    int main(void)
    {
        lanes state[18], body[23], step[1], next[18], speed;
        for (int k = 0; k < 8; k++) {
            for (int i = 0; i < 18; i++) state[i][k] = 0.25 * i - k;
            for (int i = 0; i < 23; i++) body[i][k] = 1.0 + 0.125 * i * k;
            step[0][k] = 0.01 * k;
        }
        certreg_euler_step(state, body, step, next, &speed);
        for (int k = 0; k < 8; k++) {
            for (int i = 0; i < 18; i++) printf("%.17g ", next[i][k]);
            printf("%.17g\\n", speed[k]);
        }
    }
    """
    (tmp_path / "lanes.c").write_text(lanes + main, "utf-8")
    include = f"-I{ROOT / 'certreg' / 'native' / 'generated'}"
    flags = ["-std=gnu11", "-O2", "-Wno-psabi", include]
    program = str(tmp_path / "lanes")
    subprocess.run([*compiler, *flags, str(tmp_path / "lanes.c"), "-lm", "-o", program], check=True)
    printed = subprocess.run(
        [program], capture_output=True, text=True, check=True, encoding="utf-8"
    ).stdout
    for k, line in enumerate(printed.splitlines()):
        state = np.array([0.25 * i - k for i in range(18)])
        body = np.array([1.0 + 0.125 * i * k for i in range(23)])
        step = np.array([0.01 * k])
        expected = np.concatenate(evaluator().evaluate("certreg_euler_step", state, body, step))
        assert np.allclose(np.array(line.split(), dtype=float), expected, rtol=1e-12, atol=1e-12)
    assert printed.count("\n") == 8
