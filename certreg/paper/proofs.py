"""The book's claims, proved in processes of their own while the experiments run."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from certreg.campaign import LocalWorkers
from certreg.paper import derivation

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping, Sequence
    from concurrent.futures import Future

    from certreg.results import Verdict


@contextmanager
def proving(names: Sequence[str]) -> Generator[Mapping[str, Future[Verdict]]]:
    """The verdicts on claims by name, as they come; what is not wanted any more is given up."""
    with LocalWorkers() as workers:
        yield {name: workers.executor.submit(derivation.verdict, name) for name in names}
