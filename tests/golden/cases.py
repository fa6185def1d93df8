"""The commands of the golden record, in words of the command line alone."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING

from corpus import MUTANTS, PACKAGED, RANDOM, ROOT, ROWS, bad_arguments, bad_cases

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

COMMANDS = (
    *("certify", "assess", "verify", "report", "equilibria", "simulate", "apply", "batch"),
    *("demo", "reproduce", "derive", "codegen", "info"),
)
METHODS = ("spectral", "groebner", "homotopy", "all")
INTEGRATORS = ("euler", "midpoint", "splitting")
BATCH = ("batch", "../inputs/list/pairs.csv", "--out", "results")
CAMPAIGN = ("reproduce", "--runs", "1200", "--points", "5", "--no-proofs", "--out", "paper")


class How(enum.Enum):
    """How a step is run."""

    COMMAND = "certreg"  # in a fork of a process that has loaded the libraries: fast
    FRESH = "python -m certreg"  # in a process of its own, which loads what the user's would
    CHECKER = "verify.py"  # the checker's file alone, with nothing but the standard library
    PYTHON = "python"  # a function of `public_calls.py`, in a fork


@dataclass(frozen=True)
class Step:
    arguments: tuple[str, ...]
    how: How = How.COMMAND


@dataclass(frozen=True)
class Case:
    """Steps in one folder, one after another; `begun` names a folder to start with a copy of."""

    name: str
    steps: tuple[Step, ...]
    begun: str | None = None


def cases() -> Iterator[Case]:
    """Everything that is recorded."""
    yield from _faces()
    for name, pair in PACKAGED.items():
        yield _thorough(name, *(f"../inputs/data/{side}.csv" for side in pair))
    for name in ROWS:
        sides = (f"../inputs/rows/{name}-{side}.csv" for side in ("source", "target"))
        yield _thorough(f"row-{name}", *sides)
    for number in range(RANDOM):
        yield _random(number)
    yield from _formats()
    yield from _bad()
    yield from _vectors()
    yield from _campaigns()


def begun() -> tuple[Case, ...]:
    """The campaigns that one checkout begins and every checkout goes on with."""
    return (
        Case("batch", (Step(BATCH, How.FRESH),)),
        Case("instances", (Step(CAMPAIGN, How.FRESH),)),
    )


def _steps(*commands: tuple[str, ...], how: How = How.COMMAND) -> tuple[Step, ...]:
    return tuple(Step(command, how) for command in commands)


def _faces() -> Iterator[Case]:
    """Help, versions, and the commands that read no cloud, each in a process of its own."""
    helps = ((name, "--help") for name in COMMANDS)
    yield Case("help", _steps(("--help",), ("--version",), (), ("nonsense",), *helps))
    yield Case("info", _steps(("info",), how=How.FRESH))
    yield Case("demo", _steps(("demo",), how=How.FRESH))
    yield Case("derive", _steps(("derive", "--list"), ("derive", "--out", "proofs"), how=How.FRESH))
    yield Case("derive-wrong", _steps(("derive", "nothing"), ("derive", "--list", "inertia")))
    yield Case("codegen", _steps(("codegen", "--out", "c"), ("codegen",), how=How.FRESH))
    small = ("reproduce", "--runs", "2", "--points", "6", "--seed", "7", "--out", "small")
    yield Case("reproduce", _steps(small, how=How.FRESH))
    beyond = ("reproduce", "--runs", "2", "--points", "4", "--no-proofs", "--beyond")
    yield Case("reproduce-beyond", _steps(beyond, how=How.FRESH))
    wrong = (("reproduce", "--runs", "0"), ("reproduce", "--points", "2"))
    yield Case("reproduce-wrong", _steps(*wrong))
    survey = ("../inputs/data/survey_source.csv", "../inputs/data/survey_target.csv")
    fresh = (
        ("certify", *survey, "--out", "out"),
        ("verify", "out/certificate.json"),
        ("report", "out/certificate.json", "--out", "again.html"),
        ("assess", *survey, "--pose", "out"),
        ("certify", *survey, "--max-gap", "1e-40", "--integrator", "midpoint"),
        ("equilibria", *survey, "--method", "all"),
        ("simulate", *survey),
        ("apply", "out", survey[0], "--out", "moved.csv"),
    )
    yield Case("fresh", _steps(*fresh, how=How.FRESH))
    functions = ("names", "problems", "errors", "register", "equilibria", "simulate", "certify")
    yield Case("public-calls", _steps(*((name,) for name in functions), how=How.PYTHON))


def _thorough(name: str, *clouds: str) -> Case:
    """A pair by every command and option."""
    certificate = "out/certificate.json"
    commands: list[tuple[str, ...]] = [
        ("certify", *clouds),
        ("certify", *clouds, "--json"),
        ("certify", *clouds, "--out", "out"),
        ("certify", *clouds, "--no-relaxation", "--no-simulation", "--json", "--out", "quick"),
        ("certify", *clouds, "--sigma", "2.5", "--damping", "optimal", "--out", "sigma"),
        ("verify", certificate),
        ("verify", certificate, *clouds),
        ("verify", certificate, *reversed(clouds)),
        ("verify", "sigma/certificate.json", *clouds, "--sigma", "2.5"),
        ("verify", "sigma/certificate.json", *clouds),
        ("report", certificate),
        ("report", "quick/certificate.json", "--out", "quick.html"),
        ("assess", *clouds, "--pose", "out"),
        ("assess", *clouds, "--pose", "out/pose.txt", "--json"),
        ("assess", *clouds, "--pose", "../inputs/rough-pose.txt"),
        ("assess", *clouds, "--pose", "../inputs/rough-pose.txt", "--json"),
        ("assess", *clouds, "--pose", "../inputs/scaled-pose.txt"),
        ("apply", "out", clouds[0], "--out", "moved.csv"),
        ("apply", "out/result.json", clouds[0], "--out", "moved.npy"),
        ("apply", "../inputs/rough-pose.txt", clouds[0], "--out", "moved.ply"),
        ("apply", "../inputs/scaled-pose.txt", clouds[0], "--out", "moved.txt"),
        ("equilibria", *clouds, "--out", "count.json"),
        ("verify", "count.json"),
    ]
    for method in METHODS:
        commands += [
            ("equilibria", *clouds, "--method", method),
            ("equilibria", *clouds, "--method", method, "--json"),
        ]
    for integrator in INTEGRATORS:
        start = ("simulate", *clouds, "--integrator", integrator)
        commands += [
            (*start, "--out", f"{integrator}.npz"),
            (*start, "--json", "--damping", "1.5", "--step", "0.02"),
            (*start, "--damping", "optimal"),
        ]
    alone = Step((certificate,), How.CHECKER), Step(("count.json",), How.CHECKER)
    limits = ("--max-angle", "1e-9", "--max-gap", "1e-9")
    asked = _steps(
        ("verify", "sigma/certificate.json", *clouds, "--any-weight"),
        ("verify", certificate, *limits),
        ("verify", certificate, "--max-angle", "1e-99"),
        ("verify", "count.json", *limits),
        ("verify", certificate, "--any-weight"),
    )
    return Case(
        name, (*_steps(*commands), *alone, *asked, Step((*limits, certificate), How.CHECKER))
    )


def _random(number: int) -> Case:
    """A random problem, by options that change with its number."""
    start = f"../inputs/random/{number:03}"
    clouds = (f"{start}-source.csv", f"{start}-target.csv")
    noise = ((), ("--weights", f"{start}-weights.txt"), ("--sigma", "0.01"))[number % 3]
    as_json = ("--json",) if number % 2 else ()
    integrator = ("--integrator", INTEGRATORS[number % 3])
    damping = (("--damping", "optimal"), ())[number % 2]
    commands = (
        ("certify", *clouds, *noise, *as_json, "--out", "out"),
        ("verify", "out/certificate.json", *clouds, *noise),
        ("equilibria", *clouds, *noise, "--method", "all", *as_json),
        ("equilibria", *clouds, "--method", METHODS[number % 3], "--out", "count.json"),
        ("verify", "count.json"),
        ("assess", *clouds, *noise, "--pose", f"{start}-pose.txt", *as_json),
        ("simulate", *clouds, *noise, *integrator, *damping, *as_json),
        ("apply", f"{start}-pose.txt", clouds[0], "--out", "moved.csv"),
    )
    return Case(f"random-{number:03}", _steps(*commands))


def _formats() -> Iterator[Case]:
    place, target = "../inputs/formats", "../inputs/formats/target.csv"
    names = (
        *("a.txt", "plain.xyz", "chemical.xyz", "ascii.ply", "binary.ply", "ascii.pcd"),
        *("binary.pcd", "double.npy", "single.npy", "points.npz", "labelled.csv", "extra.csv"),
    )
    quick = ("--no-relaxation", "--no-simulation", "--out", "out")
    for name in names:
        clouds = (f"{place}/{name}", target)
        commands = (
            ("certify", *clouds, *quick),
            ("verify", "out/certificate.json", *clouds),
            *(("apply", "out", clouds[0], "--out", f"moved{s}") for s in (".ply", ".txt", ".xyz")),
        )
        yield Case(f"format-{name}", _steps(*commands))
    labelled, pairs = f"{place}/labelled.csv", ("--pairs", f"{place}/pairs.txt")
    weights = ("--weights", f"{place}/weights.txt")
    pairings = {
        "reversed": (labelled, f"{place}/reversed.csv"),
        "fewer": (labelled, f"{place}/fewer.csv"),
        "common": (labelled, f"{place}/fewer.csv", "--match", "common"),
        "pairs": (f"{place}/a.txt", target, *pairs),
        "weights": (f"{place}/a.txt", target, *weights),
        "both": (f"{place}/a.txt", target, *pairs, "--match", "common"),
    }
    for name, told in pairings.items():
        commands = (("certify", *told, *quick), ("verify", "out/certificate.json", *told))
        yield Case(f"pairing-{name}", _steps(*commands))


def _bad() -> Iterator[Case]:
    for name, bad in bad_cases():
        told = bad_arguments(bad, f"../inputs/bad/{name}")
        commands = [("certify", *told, *(() if "--out" in told else ("--out", "out")))]
        if "--out" not in told:  # which may be a good place for a file, as the clouds themselves
            rough = ("--pose", "../inputs/rough-pose.txt")
            commands += [("equilibria", *told), ("simulate", *told), ("assess", *told, *rough)]
        yield Case(f"bad-{name}", _steps(*commands))
    good = ("../inputs/rows/1111-source.csv", "../inputs/rows/1111-target.csv")
    junk, nowhere, rough = "../inputs/junk.json", "nowhere.json", "../inputs/rough-pose.txt"
    commands = (
        *(("certify", ".", good[0]), ("certify", good[0]), ("certify",), ("verify",), ("apply",)),
        *(("verify", junk), ("verify", nowhere), ("verify", junk, good[0])),
        *(("verify", junk, "--sigma", "1"), ("verify", junk, "--out", "x.v")),
        *(("report", junk), ("report", nowhere), ("report", junk, "--out", junk)),
        *(
            ("assess", *good),
            ("assess", *good, "--pose", nowhere),
            ("assess", *good, "--pose", "."),
        ),
        ("assess", *good, "--pose", good[0]),
        *(("apply", nowhere, good[0], "--out", "a.csv"), ("apply", rough, good[0])),
        *(("apply", rough, nowhere, "--out", "a.csv"), ("apply", rough, good[0], "--out", "a.stl")),
        *(("simulate", *good, "--step", step) for step in ("0", "nan", "x")),
        ("simulate", *good, "--out", "motion.csv"),
        *(("simulate", *good, "--integrator", "rk4"), ("equilibria", *good, "--method", "guess")),
        *(("batch", f"../inputs/list/{name}.csv") for name in ("empty", "misspelt", "nowhere")),
        *(("batch", junk, "--parquet"), ("codegen", "--out", junk), ("demo", "--out", junk)),
    )
    yield Case("bad-rest", _steps(*commands))


def _vectors() -> Iterator[Case]:
    """Both checkers on every vector, and one of them on its mutants, too."""
    for path in sorted((ROOT / "vectors").glob("*-*.json")):
        place = f"../inputs/vectors/{path.name}"
        mutants = (f"../inputs/vectors/mutant-{k}-of-{path.name}" for k in range(MUTANTS))
        steps = (Step(("verify", place)), Step((place,), How.CHECKER))
        verdicts = Step(("verdicts", place, *mutants), How.PYTHON)
        yield Case(f"vector-{path.stem}", (*steps, verdicts))


def _campaigns() -> Iterator[Case]:
    yield Case("batch", _steps(BATCH, BATCH, BATCH[:2], how=How.FRESH))
    yield Case("resumed-batch", _steps(BATCH, how=How.FRESH), begun="batch")
    other = ("batch", "../inputs/list/misspelt.csv", "--out", "results")
    yield Case("foreign-batch", _steps(other, how=How.FRESH), begun="batch")
    yield Case("resumed-instances", _steps(CAMPAIGN, how=How.FRESH), begun="instances")
    yield Case("foreign-instances", _steps((*CAMPAIGN, "--seed", "1")), begun="instances")


def half_done(folder: Path) -> None:
    """A finished campaign with every third shard away, one cut short, and no tables."""
    for shards in sorted(folder.rglob("shards")):
        files = sorted(shards.iterdir())
        for path in files[::3]:
            path.unlink()
        files[1].write_bytes(files[1].read_bytes()[:-7])
        for path in shards.parent.iterdir():
            if path.is_file() and path.name != "campaign.json":
                path.unlink()
