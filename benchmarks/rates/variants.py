"""Whether every variant of the compiled code gives the same bytes, and passes the whole suite.

    make rates NAME=variants ARGS="[PAIRS]"     the suite, too: so many minutes for each variant
    make rates NAME=variants ARGS="digests [PAIRS]"

Of PAIRS pairs, 400 unless told: certificates, certified lists of equilibria, consensus, truncated
squares, general springs, motions, poses. One digest of each, by every variant that gcc, clang and
Zig make and this processor runs; what was left out is named. No baseline holds an instruction
above its level. Then the suite, on every variant of this checkout.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from dataclasses import astuple
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import spring_families
from instructions import above_the_baseline, listing_of
from wrong_pairs import wrong_pairs

import build_kernels
from certreg import (
    Pose,
    RegistrationProblem,
    bodies_of,
    certify,
    register,
    simulate,
    simulate_many,
    solve_many,
)
from certreg.native import kernels

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from certreg.native.kernels import Built

ROOT = Path(__file__).parents[2]
PAIRS = 400
COMPILERS = ("gcc", "clang", "zig cc")
INTEGRATORS = ("euler", "midpoint", "splitting")
LISTED = spring_families.LISTED


def clouds(rng: np.random.Generator) -> tuple[Any, Any, Any]:
    """Source, target, weights of 4 to 200 points, at any noise, unit and distance."""
    n = int(rng.integers(4, 200))
    source = rng.normal(size=(n, 3)) * np.exp(rng.uniform(-1.0, 1.0, 3))
    noise = 10.0 ** -rng.uniform(0.0, 6.0) * rng.normal(size=(n, 3))
    target = source @ spring_families.uniform_rotation(rng).T + noise
    unit = 10.0 ** rng.uniform(-3.0, 3.0)
    places = 10.0 ** rng.uniform(-1.0, 4.0, 2)
    return unit * (source + places[0]), unit * (target - places[1]), rng.uniform(0.1, 1.0, n)


def pair_certificate(rng: np.random.Generator) -> bytes:
    """Of least squares."""
    source, target, weights = clouds(rng)
    made: Any = certify(RegistrationProblem(source, target, weights=weights), relaxation=False)
    return made.certificate.to_json()


def springs_certificate(rng: np.random.Generator) -> bytes:
    """Of planes, lines or covariances, with the certified list of its equilibria and its motion."""
    made = spring_families.instance(LISTED[int(rng.integers(len(LISTED)))], int(rng.integers(1000)))
    problem = RegistrationProblem(**spring_families.statement(made))
    motion: Any = simulate(problem)
    listed = motion.listed
    certified: Any = certify(problem)
    parts = certified.certificate.to_json(), listed.to_json() if listed else b"none"
    return b"".join((*parts, repr(motion.to_dict()).encode()))


def labels_certificate(rng: np.random.Generator) -> bytes:
    """Of consensus, and of truncated squares about a point that does not move."""
    points, share = int(rng.integers(20, 80)), float(rng.uniform(0.0, 0.5))
    made = wrong_pairs(rng, points, share)
    target = made.target - made.target[made.true].mean(axis=0)
    source = made.source - made.source[made.true].mean(axis=0)
    few = slice(0, 12)
    truncated: Any = certify(
        source[few],
        target[few],
        max_residual=made.bounds[few],
        objective="truncated",
        rotation_only=True,
    )
    consensus: Any = certify(made.source, made.target, max_residual=made.bounds)
    return consensus.certificate.to_json() + truncated.certificate.to_json()


def motions(rng: np.random.Generator) -> bytes:
    """By each integrator, one body and several at a time."""
    source, target, _ = clouds(rng)
    problem, words = RegistrationProblem(source, target), b""
    for integrator in INTEGRATORS:
        alone: Any = simulate(problem, integrator)
        words += repr(astuple(alone)).encode()
        others = [target + rng.normal(size=target.shape) for _ in range(9)]
        ends = simulate_many(bodies_of([source] * 9, others), integrator)
        words += repr(astuple(ends)).encode()
    return words


def poses(rng: np.random.Generator) -> bytes:
    """In floating point: of rows, of columns, of single numbers, of many pairs."""
    source, target, weights = clouds(rng)
    forms: tuple[Callable[[Any], Any], ...] = (np.asfortranarray, np.ascontiguousarray, np.float32)
    found = [register(form(source), form(target), weights) for form in forms]
    assert all(isinstance(pose, Pose) for pose in found)
    many = solve_many([source] * 3, [target, target + 1.0, target[::-1]], spectrum=True)
    return repr((found, astuple(many))).encode()


KINDS: dict[str, Callable[[np.random.Generator], bytes]] = {
    "certificates": pair_certificate,
    "springs and lists": springs_certificate,
    "consensus and truncated": labels_certificate,
    "motions": motions,
    "poses": poses,
}


def digests(pairs: int) -> dict[str, str]:
    """SHA-256 over so many pairs, by the library of this process."""
    np.set_printoptions(threshold=sys.maxsize, floatmode="unique")
    found: dict[str, str] = {}
    for kind, content in KINDS.items():
        whole = hashlib.sha256()
        for seed in range(pairs):
            whole.update(content(np.random.default_rng([seed, len(found)])))
        found[kind] = whole.hexdigest()[:16]
    return found


def digests_of(folder: Path, variant: str, pairs: int) -> dict[str, str]:
    """The same in a process of its own, by a variant of what was built in a folder."""
    command = [sys.executable, "-m", "benchmarks.rates.variants", "child", str(pairs), str(folder)]
    paths = os.pathsep.join((str(ROOT), str(ROOT / "tests")))
    environment = {**os.environ, kernels.VARIANT: variant, "PYTHONPATH": paths}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout)


def compared(pairs: int) -> bool:
    """Print the digests of every compiler and variant; whether they are the same."""
    found: dict[str, dict[str, str]] = {}
    clean = True
    for name in COMPILERS:
        if shutil.which(name.split()[0]) is None:
            print(f"left out: {name}: not on this machine")
            continue
        with _folder_of(name) as folder:
            built = kernels.record_of(folder)
            clean &= _is_clean(name, built, folder)
            here = kernels.runnable(built, folder)
            for variant in kernels.LEVELS:
                if variant not in here:
                    print(f"left out: {name}, {variant}: this processor or compiler has none")
                    continue
                made = found[f"{name}, {variant}"] = digests_of(folder, variant, pairs)
                print(f"{name}, {variant}: {made}", flush=True)
    same = len({tuple(made.values()) for made in found.values()}) == 1
    verdict = "the same bytes" if same else "DIFFERENT BYTES"
    print(f"{pairs} pairs of each kind, {len(found)} variants: {verdict}")
    return same and clean


@contextmanager
def _folder_of(compiler: str) -> Iterator[Path]:
    """What a compiler makes, in a folder that goes."""
    with tempfile.TemporaryDirectory(prefix="certreg-variants-") as name:
        os.environ["CC"] = compiler
        try:
            built = build_kernels.build(Path(name), checkout=False, set_up=False)
        finally:
            del os.environ["CC"]
        if built.why:
            raise SystemExit(built.why)
        yield Path(name)


def _is_clean(name: str, built: Built, folder: Path) -> bool:
    """Whether the baseline and what tells the level hold no instruction above their level."""
    if not build_kernels.X86:
        return True
    libraries = (built.processor, built.variants[kernels.BASELINE])
    above = {word for file in libraries for word in above_the_baseline(listing_of(folder / file))}
    print(f"{name}, baseline: {' '.join(sorted(above)) or 'no instruction'} above its level")
    return not above


def suite() -> bool:
    """Run the suite on every variant of this checkout; whether all pass."""
    codes: dict[str, int] = {}
    for variant in kernels.runnable(kernels.record_of(kernels.BUILT), kernels.BUILT):
        print(f"the suite on {variant}:", flush=True)
        command = [sys.executable, "-X", "warn_default_encoding", "-m", "pytest", "-q"]
        environment = {**os.environ, kernels.VARIANT: variant}
        codes[variant] = subprocess.run(command, env=environment, cwd=ROOT, check=False).returncode
    print(f"exit codes of the suite: {codes}")
    return not any(codes.values())


def main() -> int:
    """Compare, then run the suite unless only digests are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("words", nargs="*")
    words: list[str] = parser.parse_args().words
    if words[:1] == ["child"]:
        kernels.BUILT = Path(words[2])
        print(json.dumps(digests(int(words[1]))))
        return 0
    only = words[:1] == ["digests"]
    pairs = int(words[only]) if words[only:] else PAIRS
    same = compared(pairs)
    return 0 if same and (only or suite()) else 1


if __name__ == "__main__":
    sys.exit(main())
