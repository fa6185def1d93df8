"""Mutants of the functions that prove: `make rates NAME=mutants` judges all (some minutes).

    ARGS="--every 100"          one mutant in a hundred, another one for another --seed
    ARGS="--only certificate/"  of the functions whose file and name hold these letters

Each mutant is judged in a forked process by the tests that `tests/proved_functions.py` names and
that call its function, the quickest first. A full run writes
benchmarks/acceptance/mutants.json; with survivors, or with a reason for one that does not survive,
the exit code is 1. What was judged before is not judged again, while its file and its tests stay;
a sample is judged in any case.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from function_mutants import EQUIVALENT, mutants_of
from mutants import ROOT, Mutant, change, functions
from proved_functions import PROVED, Proved

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from types import CodeType

RESULT = ROOT / "benchmarks" / "acceptance" / "mutants.json"
STORE = ROOT / "build" / "mutants.json"  # what was judged before
LONGEST = 2.0  # seconds: no test that takes more judges a mutant
PATIENCE = 10.0  # seconds of the processor beside ten times what the tests take
MEMORY = 4 << 30  # bytes more than at the start: a mutant may shift by any number of bits
TIMEOUT = "it took too long"


@dataclass(slots=True)
class Judge:
    """A plugin that judges mutants in the place of running the tests that pytest collected.

    reach: of each function the tests that call it, with the seconds they take.
    """

    mutants: Sequence[Mutant]
    remembers: bool  # what was judged before, and what is now
    said: Callable[[str, str | None], None]
    reach: dict[str, list[tuple[float, str]]] = field(default_factory=dict)
    known: dict[str, str | None] = field(default_factory=dict)
    failed: str | None = None

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        self.known = stored() if self.remembers else {}
        items = {item.nodeid: item for item in session.items}
        for tests in sorted({mutant.claims for mutant in self.mutants}):
            asked = [m for m in self.mutants if m.claims == tests]
            chosen = [i for i in session.items if str(i.path.relative_to(ROOT)) in tests]
            named = {_function(mutant) for mutant in asked}
            self.reach |= apart(lambda chosen=chosen, named=named: self.survey(chosen, named)) or {}
            for mutant in asked:
                self.judge(mutant, items)
            self.keep()
        return True

    def keep(self) -> None:
        if not self.remembers:
            return
        self.known = stored() | self.known
        STORE.parent.mkdir(exist_ok=True)
        new = STORE.with_suffix(f".{os.getpid()}")
        new.write_text(json.dumps(self.known), "utf-8")
        new.replace(STORE)

    def survey(self, items: Iterable[pytest.Item], named: set[str]) -> dict[str, Any]:
        """The tests that call these functions, as nothing is mutated, by their seconds."""
        codes = _codes(named)
        reach: dict[str, list[tuple[float, str]]] = {name: [] for name in named}
        for item in items:
            seen = set[str]()

            def note(frame: Any, event: str, _: Any, seen: set[str] = seen) -> None:
                if event == "call" and frame.f_code in codes:
                    seen.add(codes[frame.f_code])

            start = time.process_time()
            sys.setprofile(note)
            try:
                failed = self.fails(item)
            finally:
                sys.setprofile(None)
            if failed:
                raise RuntimeError(f"{item.nodeid} fails without a mutant")
            seconds = time.process_time() - start
            for name in seen if seconds < LONGEST else ():
                reach[name].append((seconds, item.nodeid))
        return {name: sorted(tests) for name, tests in reach.items()}

    def judge(self, mutant: Mutant, items: dict[str, pytest.Item]) -> None:
        tests = self.reach[_function(mutant)]
        key = _key(mutant, [name for _, name in tests])
        if self.known.get(key) is None:
            seconds = 10 * sum(spent for spent, _ in tests) + PATIENCE

            def noticed() -> str | None:
                change(mutant)
                return next((name for _, name in tests if self.fails(items[name])), None)

            self.known[key] = apart(noticed, seconds=seconds)
        self.said(mutant.says, self.known[key])

    def fails(self, item: pytest.Item) -> bool:
        self.failed = None
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
        return self.failed is not None

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.failed = report.nodeid


def stored() -> dict[str, str | None]:
    """What was judged before, by runs of other functions, too."""
    return json.loads(STORE.read_text("utf-8")) if STORE.exists() else {}


def apart(ask: Callable[[], Any], *, seconds: float = 0.0) -> Any:
    """The answer of a forked process; TIMEOUT where it takes more seconds, if they are limited."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _answer(ask, seconds, writing)
    os.close(writing)
    with os.fdopen(reading, encoding="utf-8") as answer:
        text = answer.read()
    _, status = os.waitpid(child, 0)
    if text:
        return json.loads(text)
    if seconds and os.WIFSIGNALED(status):
        return TIMEOUT if os.WTERMSIG(status) == signal.SIGPROF else "it killed the process"
    raise RuntimeError("the forked process ended without an answer")


def _answer(ask: Callable[[], Any], seconds: float, writing: int) -> None:
    errors = os.dup(2)
    try:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        if seconds:
            signal.setitimer(signal.ITIMER_PROF, seconds)
            used = int(Path("/proc/self/statm").read_text("ascii").split()[0]) * 4096
            resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
        os.write(writing, json.dumps(ask()).encode())
    except BaseException as error:  # noqa: BLE001 - nothing may leave a forked process
        os.write(errors, f"{type(error).__name__}: {error}\n".encode())
    finally:
        os._exit(0)


def _function(mutant: Mutant) -> str:
    return ":".join(mutant.says.split(":")[:2])


def _codes(named: set[str]) -> dict[CodeType, str]:
    found: dict[CodeType, str] = {}
    for name in named:
        file, function = name.split(":")
        module = import_module(file.removesuffix(".py").replace("/", "."))
        found[functions(module)[function].__code__] = name
    return found


def _key(mutant: Mutant, tests: list[str]) -> str:
    """The same for the same change of the same file, judged by tests of the same text."""
    files = sorted({name.split("::")[0] for name in tests} | {mutant.file})
    texts = [(ROOT / name).read_text("utf-8") for name in files]
    content = json.dumps([mutant.says, mutant.new, tests, *texts])
    return hashlib.sha256(content.encode()).hexdigest()[:24]


def all_mutants(rows: Sequence[Proved] = PROVED) -> list[Mutant]:
    """Of every listed function every mutant, with the modules of its tests."""
    return [
        mutant
        for row in rows
        for name in row.functions
        for mutant in mutants_of(row.file, name, tuple(f"tests/{t}.py" for t in row.tests))
    ]


def chosen(every: int, seed: int, only: str) -> list[Mutant]:
    """One in so many, without those that are equivalent where not all are asked."""
    listed = [mutant for mutant in all_mutants() if only in _function(mutant)]
    if every == 1:
        return listed
    listed = [mutant for mutant in listed if mutant.says not in EQUIVALENT]
    count = -(-len(listed) // every)
    return random.Random(seed).sample(listed, count)


def judged(mutants: Sequence[Mutant], *, remembers: bool) -> dict[str, str | None]:
    """By which test each mutant was noticed; None for survivors."""
    found: dict[str, str | None] = {}

    def said(name: str, test: str | None) -> None:
        found[name] = test
        if test is None and name not in EQUIVALENT:
            sys.stderr.write(f"survives: {name}\n")

    judge = Judge(mutants, remembers, said)
    files = sorted({test for mutant in mutants for test in mutant.claims})
    options = ["-q", "-q", "-s", "-p", "no:cacheprovider", "-m", "not long"]
    code = pytest.main([*options, *(str(ROOT / file) for file in files)], plugins=[judge])
    if code != pytest.ExitCode.OK:
        raise RuntimeError(f"pytest ended with {code!r}")
    return found


def main() -> int:
    """Judge, print a line, and write the result of a full run."""
    parser = argparse.ArgumentParser(description="Mutants of the functions that prove.")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    mutants = chosen(arguments.every, arguments.seed, arguments.only)
    if not mutants:
        parser.error(f"no listed function has {arguments.only!r} in its file and name")
    start = time.process_time()
    found = judged(mutants, remembers=arguments.every == 1)
    survivors = [name for name, test in found.items() if test is None and name not in EQUIVALENT]
    noticed = [name for name, test in found.items() if test is not None and name in EQUIVALENT]
    result = {
        "commit": _commit(),
        "seed": arguments.seed,
        "every": arguments.every,
        "functions": len({_function(mutant) for mutant in mutants}),
        "mutants": len(found),
        "equivalent": len(EQUIVALENT.keys() & found.keys()),
        "survivors": survivors,
        "equivalents that a test notices": noticed,
        "seconds": round(time.process_time() - start + _of_children(), 1),
    }
    print(json.dumps(result, indent=1))
    if arguments.every == 1 and not arguments.only:
        RESULT.write_text(json.dumps(result, indent=1) + "\n", "utf-8")
    return 1 if survivors or noticed else 0


def _of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _commit() -> str:
    command = ["git", "-C", str(ROOT), "rev-parse", "--short=12", "HEAD"]
    return subprocess.run(
        command, capture_output=True, text=True, check=True, encoding="utf-8"
    ).stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
