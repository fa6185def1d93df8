"""Run the measurements, print each figure with its bound; exit code 1 if one is missed."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from benchmarks import (
    accuracy,
    checking,
    computing,
    importing,
    phases,
    relaxing,
    roads,
    simulating,
)
from benchmarks.measuring import Figure, machine

MEASUREMENTS = {
    module.__name__.rpartition(".")[2]: module
    for module in (computing, checking, importing, accuracy, phases, relaxing, roads, simulating)
}


def main() -> int:
    options = _parser().parse_args()
    if options.list:
        for name, module in MEASUREMENTS.items():
            print(f"{name:<12}{(module.__doc__ or '').splitlines()[0]}")
        return 0
    place = machine()
    print(", ".join(f"{key} {value}" for key, value in place.items()))
    figures = {name: _run(name) for name in options.only or MEASUREMENTS}
    if options.json:
        results = {name: [figure.as_json() for figure in row] for name, row in figures.items()}
        text = json.dumps({"machine": place, "figures": results}, indent=1, ensure_ascii=False)
        options.json.write_text(text + "\n", encoding="utf-8")
    missed = sum(figure.passed is False for row in figures.values() for figure in row)
    print(f"\n{missed} missed" if missed else "\nall bounds kept")
    return 1 if missed else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--only", metavar="NAME", action="append", choices=MEASUREMENTS)
    parser.add_argument("--list", action="store_true", help="name the measurements")
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the figures to a file")
    return parser


def _run(name: str) -> list[Figure]:
    module = MEASUREMENTS[name]
    print(f"\n{name}: {(module.__doc__ or '').splitlines()[0]}")
    figures: list[Figure] = []
    for figure in module.measure():
        print(figure, flush=True)
        figures.append(figure)
    return figures


if __name__ == "__main__":
    sys.exit(main())
