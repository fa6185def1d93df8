"""Under a limit on memory that is too low there is a message, whatever the libraries would do."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from commands import certreg

from certreg.cli import memory
from certreg.errors import MissingToolError

ROOT = Path(__file__).parents[2]
LITTLE = 1 << 26
MESSAGE = re.compile(
    r"(certreg: )?the \d+ MB of memory that this process may use are too few to load NumPy .*: "
    r"raise the limit \(ulimit -v\), or set OPENBLAS_NUM_THREADS=1\n?"
)


@pytest.fixture
def limited(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if there were a limit, but one under which Python still runs."""
    monkeypatch.setattr(memory, "memory_limit", lambda: LITTLE + memory.RESERVE)


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.usefixtures("limited")
@pytest.mark.parametrize(
    "ends",
    [
        "raise MemoryError",
        "import os; os._exit(1)",  # as OpenBLAS does, "giving up"
        "import os, signal; signal.signal(2, signal.SIG_DFL); os.kill(os.getpid(), 2)",  # no thread
        "import os; os.kill(os.getpid(), 11)",
        "bytearray(1 << 27)",  # more than is left
        pytest.param("while True: pass", marks=pytest.mark.long),  # as it does, too
    ],
)
def test_libraries_that_do_not_load_are_a_message(ends, monkeypatch):
    monkeypatch.setattr(memory, "PATIENCE", 0.5)

    with pytest.raises(MissingToolError) as caught:
        memory.require_loadable(ends)
    assert MESSAGE.fullmatch(str(caught.value))


@pytest.mark.usefixtures("limited")
def test_what_loads_in_a_process_of_its_own_is_loaded_here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    memory.require_loadable(
        "with open('loaded', 'a', encoding='utf-8') as file: print('once', file=file)"
    )

    assert (tmp_path / "loaded").read_text("utf-8") == "once\n" * 2


@pytest.mark.parametrize("limit", [None, 1 << 40])
def test_with_enough_memory_nothing_is_tried(limit, monkeypatch):
    tried: list[object] = []
    monkeypatch.setattr(memory, "memory_limit", lambda: limit)

    monkeypatch.setattr(memory, "_succeeds", tried.append)

    memory.require_loadable("raise MemoryError")

    assert tried == []


def test_commands_that_compute_say_so_and_the_checker_runs(data, monkeypatch):
    tried: list[str] = []
    monkeypatch.setattr(memory, "memory_limit", lambda: LITTLE)
    monkeypatch.setattr(memory, "_succeeds", lambda command: tried.append(command[-1]))
    pair = (data / "survey_source.csv", data / "survey_target.csv")

    for command in (["certify", *pair], ["certify", *pair, "--no-relaxation"], ["info"]):
        run = certreg(*command)
        assert (run.code, run.out) == (2, "")
        assert MESSAGE.fullmatch(run.err)
    assert ["scipy" in code for code in tried] == [True, False, False]
    assert certreg("verify", ROOT / "vectors" / "accept-pattern-1111.json").code == 0
    assert len(tried) == 3


@pytest.mark.slow
@pytest.mark.one_in(2)
@pytest.mark.parametrize("size", [80, 200])
def test_a_real_limit_ends_in_the_message(size, data):
    code = (
        f"import resource; resource.setrlimit(resource.RLIMIT_AS, ({size} << 20, {size} << 20))\n"
        "import sys; from certreg.cli.main import main; main()"
    )
    pair = (data / "survey_source.csv", data / "survey_target.csv")
    start = time.monotonic()
    run = subprocess.run(
        [sys.executable, "-c", code, "certify", *pair],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        encoding="utf-8",
    )

    assert (run.returncode, run.stdout) == (2, "")
    assert MESSAGE.fullmatch(run.stderr)
    assert time.monotonic() - start < 2 * memory.PATIENCE
