"""A run as a document: what was measured, where, when and of what; `schema.json` says its form."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmarks.machine import commit, load, machine, versions
from benchmarks.measuring import Figure, Series
from benchmarks.peers import presences
from certreg.io.atomic import write_atomically

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import ModuleType

HERE = Path(__file__).parent
LATEST = HERE / "results" / "latest.json"
SCHEMA = HERE / "schema.json"
NAME = "certreg-benchmarks/1"


@dataclass(slots=True)
class Run:
    """A run while it is made: figures and series gather under the names of their modules."""

    start: datetime = field(default_factory=lambda: datetime.now(UTC))
    load: list[float] | None = field(default_factory=load)
    commit: dict[str, Any] | None = field(default_factory=commit)
    figures: dict[str, list[Figure]] = field(default_factory=dict)
    series: dict[str, list[Series]] = field(default_factory=dict)

    def measure(self, modules: Mapping[str, ModuleType]) -> None:
        """Go through the modules, print what each measures as it comes."""
        for name, module in modules.items():
            print(f"\n{name}: {(module.__doc__ or '').splitlines()[0]}")
            for found in module.measure():
                print(found, flush=True)
                if isinstance(found, Series):
                    self.series.setdefault(name, []).append(found)
                else:
                    self.figures.setdefault(name, []).append(found)

    @property
    def missed(self) -> list[str]:
        """The figures whose bounds are not kept."""
        return [
            f"{name}: {figure.what}"
            for name, row in self.figures.items()
            for figure in row
            if figure.passed is False
        ]

    def document(self) -> dict[str, Any]:
        """All of it, as JSON has it."""
        return {
            "schema": NAME,
            "date": self.start.isoformat(timespec="seconds"),
            "seconds": round((datetime.now(UTC) - self.start).total_seconds(), 1),
            "commit": self.commit,
            "machine": machine(),
            "load": {"start": self.load, "end": load()},
            "versions": versions(),
            "peers": [presence.as_json() for presence in presences()],
            "missed": self.missed,
            "figures": _documents(self.figures),
            "series": _documents(self.series),
        }

    def write(self, path: Path) -> None:
        """The document as a file, whole or not at all. Raises InvalidFileError."""
        text = json.dumps(self.document(), indent=1, ensure_ascii=False, allow_nan=False)
        write_atomically(path, (text + "\n").encode())


def read(path: Path = LATEST) -> dict[str, Any]:
    """The document of a run: the last one that was committed."""
    return json.loads(path.read_text("utf-8"))


def _documents(found: Mapping[str, list[Any]]) -> dict[str, list[dict[str, Any]]]:
    return {name: [each.as_json() for each in row] for name, row in found.items()}
