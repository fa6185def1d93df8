"""Run the measurements, print each figure with its bound; exit code 1 if one is missed."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks import (
    accuracy,
    certifying,
    checking,
    comparing,
    computing,
    everyday,
    importing,
    instances,
    phases,
    plots,
    proving,
    relaxing,
    roads,
    simulating,
    squares,
    streaming,
)
from benchmarks.machine import load, machine, versions
from benchmarks.peers import presences
from benchmarks.run import Run, read

MEASUREMENTS = {
    module.__name__.rpartition(".")[2]: module
    for module in (
        computing,
        checking,
        certifying,
        everyday,
        importing,
        comparing,
        accuracy,
        phases,
        proving,
        relaxing,
        roads,
        simulating,
        squares,
        streaming,
        instances,
    )
}


def main() -> int:
    options = _parser().parse_args()
    if options.list:
        for name, module in MEASUREMENTS.items():
            print(f"{name:<12}{(module.__doc__ or '').splitlines()[0]}")
        return 0
    _introduce()
    if options.peers:
        return 0
    run = Run()
    run.measure({name: MEASUREMENTS[name] for name in options.only or MEASUREMENTS})
    print(f"\nload {load()}")
    if options.json:
        run.write(options.json)
        print(f"written: {options.json}")
        for plot in plots.write(read(options.json), options.json.parent):
            print(f"written: {plot}")
    for missed in run.missed:
        print(f"missed: {missed}")
    print("bounds were missed" if run.missed else "all bounds kept")
    return 1 if run.missed else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--only", metavar="NAME", action="append", choices=MEASUREMENTS)
    parser.add_argument("--list", action="store_true", help="name the measurements")
    parser.add_argument("--peers", action="store_true", help="name the machine and the peers")
    parser.add_argument(
        "--json", metavar="FILE", type=Path, help="write the run to a file, its plots beside it"
    )
    return parser


def _introduce() -> None:
    facts = {**machine(), **versions(), "load": load()}
    print("\n".join(f"{name:<10} {fact}" for name, fact in facts.items()))
    for found in presences():
        print(f"{found.peer.name:<16} {found.version or f'absent: {found.absent}'}")


if __name__ == "__main__":
    sys.exit(main())
