"""Certificates of many small problems, made and written, a second of one core; the checker on some.

The bound is meant where the yardstick of `everyday` takes 100 us, and is scaled by what it takes.
"""

from __future__ import annotations

import tempfile
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import certreg
from benchmarks.everyday import YARDSTICK, yardstick
from benchmarks.measuring import Figure, Quantity
from certreg.problem.problem import RegistrationProblem
from certreg.verify import check

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

COUNT, POINTS, SAMPLE, ROUNDS = 2000, 100, 1000, 5
ALONE = 20  # problems that are certified one by one, for the ratio
RATE = 5000.0  # a second and core


def measure() -> Iterator[Figure]:
    rng = np.random.default_rng(0)
    sources = rng.normal(size=(COUNT, POINTS, 3))
    targets = sources[:, :, [1, 2, 0]] + 0.01 * rng.normal(size=sources.shape)
    scale = yardstick() / YARDSTICK
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "many.jsonl"
        work = partial(_written, sources, targets, path)
        made, alone = _fastest(work, COUNT), _fastest(partial(_one_by_one, sources, targets), ALONE)
        lines = path.read_bytes().splitlines()
    scale = min(scale, yardstick() / YARDSTICK)
    accepted = sum(check(lines[k]).verified for k in rng.permutation(COUNT)[:SAMPLE])
    yield Figure(
        what=f"certificates written, N = {POINTS}",
        value=Quantity(round(1.0 / made), "/s"),
        least=RATE / scale,
        beside={
            "where the yardstick takes 100 us": Quantity(round(scale / made), "/s"),
            "certify one by one": Quantity(round(1.0 / alone), "/s"),
        },
    )
    what = f"accepted of {SAMPLE} drawn at random"
    yield Figure(what=what, value=Quantity(accepted, ""), least=SAMPLE)


def _written(sources: np.ndarray, targets: np.ndarray, path: Path) -> None:
    certreg.certify_many(sources, targets).save(path)


def _one_by_one(sources: np.ndarray, targets: np.ndarray) -> None:
    for source, target in zip(sources[:ALONE], targets[:ALONE], strict=True):
        problem = RegistrationProblem(source, target)
        found = certreg.certify(problem, relaxation=False, simulation=False)
        assert found.certificate is not None
        found.certificate.to_json()


def _fastest(work: Callable[[], None], count: int) -> float:
    """Processor seconds of one of so many, in the cheapest call."""
    times: list[float] = []
    for _ in range(ROUNDS):
        start = time.process_time()
        work()
        times.append((time.process_time() - start) / count)
    return min(times)
