"""The compiled library to load: of those built with the package the widest that this machine runs.

A wheel carries them; in a checkout the set-up builds them into certreg/native/built (see
build_kernels.py), and here is checked that they are of the sources that stand there now. Nothing is
compiled at run time.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from certreg.errors import CertregError
from certreg.verify import shown

HERE = Path(__file__).resolve().parent
GENERATED = HERE / "generated"
SIGNATURES = tuple(GENERATED / f"{kind}signatures.json" for kind in ("", "breathing_", "spring_"))
BUILT = HERE / "built"
RECORD = "built.json"  # what stands in that folder, and of what it was made
PROCESSOR = HERE / "processor.c"
INCLUDED = (GENERATED / "dynamics.c", GENERATED / "spring_dynamics.c")  # by loops, too
UNITS = (
    *INCLUDED,
    GENERATED / "breathing_dynamics.c",
    HERE / "agreement.c",
    HERE / "escape.c",
    HERE / "midpoint.c",
    HERE / "single.c",
    HERE / "lanes.c",
    HERE / "exact.c",
    HERE / "exact_springs.c",
    HERE / "limbs.c",
    HERE / "certifying.c",
    HERE / "cliques.c",
    HERE / "cones.c",
    HERE / "eigenbasis.c",
    HERE / "fixed.c",
    HERE / "lawson.c",
    HERE / "paths.c",
    HERE / "pencil.c",
    HERE / "pose.c",
    HERE / "spring_escape.c",
    HERE / "spring_lanes.c",
    HERE / "spring_midpoint.c",
    HERE / "spring_single.c",
    HERE / "springs.c",
    HERE / "stationary.c",
    HERE / "sums.c",
    HERE / "thinning.c",
)
HEADERS = (
    GENERATED / "breathing_dynamics.h",
    GENERATED / "breathing_layout.h",
    GENERATED / "dynamics.h",
    GENERATED / "layout.h",
    GENERATED / "spring_dynamics.h",
    GENERATED / "spring_layout.h",
    *(
        HERE / name
        for name in (
            *("certifying.h", "loops.h", "lanes.h", "loop.h", "exact.h", "fixed.h"),
            *("cones.h", "exact_springs.h", "exponents.h", "eigen.h", "eigenbasis.h"),
            *(
                "agreement.h",
                "cliques.h",
                "jacobi.h",
                "lawson.h",
                "midpoint.h",
                "paths.h",
                "pencil.h",
                "pose.h",
                "spring_loop.h",
                "springs.h",
                "stationary.h",
                "sums.h",
                "thinning.h",
                "unpacked.h",
            ),
        )
    ),
)
# No -ffast-math: a NaN must stay one. -fno-math-errno: sqrt as one instruction. -ffp-contract=off:
# processors with and without fused operations round alike.
FLAGS = ("-std=gnu11", "-O3", "-fno-math-errno", "-ffp-contract=off", "-fPIC", "-Wno-psabi")
# GCC's vectorizer may fuse a product with what is in turn added and subtracted all the same (up to
# 14 at least): where complex numbers and quaternions are multiplied it is not asked.
PLAIN_FLAG = "-fno-tree-vectorize"
PLAIN = (HERE / "escape.c", HERE / "paths.c")
BASELINE = "baseline"
LEVELS = {BASELINE: 1, "x86-64-v3": 3, "x86-64-v4": 4}  # of certreg_level in processor.c
VARIANT = "CERTREG_VARIANT"  # names a narrower one, or PYTHON
PYTHON = "python"  # none: Python runs the generated C
REMEDY = "run `make kernels`, or install certreg again"


class MissingLibraryError(CertregError):
    """There is no compiled library; the message says why."""


class VariantError(CertregError):
    """The variant that the environment names is none, or not there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Built:
    """What the build left.

    digest: of the sources. checkout: whether it stands beside them, where they may be changed.
    compiler: its own words. asked: what CC said, empty where it said nothing. variants: file
    names, by the names in `LEVELS`. processor: the file name of the library that tells the level.
    why: there is no library; empty where there is one.
    """

    digest: str
    checkout: bool
    compiler: str
    asked: str
    processor: str
    variants: dict[str, str]
    why: str


def flags_of(unit: Path) -> tuple[str, ...]:
    """What a compiler is told for a file, at every level."""
    return (*FLAGS, PLAIN_FLAG) if unit in PLAIN else FLAGS


def source_digest() -> str:
    """The digest of all that the libraries are made of."""
    flags = [flags_of(unit) for unit in UNITS]
    content = hashlib.sha256(repr((flags, LEVELS)).encode())
    for path in (PROCESSOR, *UNITS, *HEADERS):
        content.update(hashlib.sha256(path.read_bytes()).digest())
    return content.hexdigest()


def record_of(folder: Path) -> Built:
    """What stands in a folder. Raises MissingLibraryError where nothing was built."""
    try:
        document: Any = json.loads((folder / RECORD).read_text("utf-8"))
        return Built(**document)
    except (OSError, ValueError, TypeError) as error:
        raise MissingLibraryError(f"certreg's C code is not built: {REMEDY}") from error


def chosen_library() -> tuple[Path, str]:
    """The library for this processor, and what it is.

    Raises MissingLibraryError where there is none, or none is wanted, and VariantError where there
    is not the one that is named.
    """
    named = os.environ.get(VARIANT, "")
    if named == PYTHON:
        raise MissingLibraryError(f"{VARIANT} is {PYTHON}")
    if named and named not in LEVELS:
        raise VariantError(f"{VARIANT} is {shown(named)}: {_choice(LEVELS)}")
    try:
        folder, built = _usable()
    except MissingLibraryError as error:
        if named:
            raise VariantError(f"{VARIANT} is {named}, but {error}") from error
        raise
    here = runnable(built, folder)
    if named and named not in here:
        raise VariantError(
            f"{VARIANT} is {named}, which this processor or build lacks: {_choice(here)}"
        )
    variant = named or here[-1]
    return folder / built.variants[variant], f"{variant}, {built.compiler}"


def _choice(names: Iterable[str]) -> str:
    return f"give {', '.join(names)} or {PYTHON}"


def _usable() -> tuple[Path, Built]:
    """The folder to load from, and what was built there, of the sources that stand there now."""
    folder, built = _found()
    if built.checkout and built.digest != source_digest():
        raise MissingLibraryError(f"certreg's C code differs from what was built: {REMEDY}")
    if built.why:
        raise MissingLibraryError(built.why)
    return folder, built


def _found() -> tuple[Path, Built]:
    """The folder to load from, and what was built there. Raises MissingLibraryError.

    Beside the sources that run; where nothing is, and Python was started in a checkout whose
    package hides the installed one, that of the installed one, if it is of the same sources.
    """
    try:
        return BUILT, record_of(BUILT)
    except MissingLibraryError:
        from importlib.metadata import PackageNotFoundError, distribution

        with suppress(PackageNotFoundError, MissingLibraryError):
            folder = Path(str(distribution("certreg").locate_file("certreg/native/built")))
            built = record_of(folder)
            if built.digest == source_digest():
                return folder, built
        raise


def runnable(built: Built, folder: Path) -> list[str]:
    """The names of the variants that this processor runs, the widest last."""
    level = LEVELS[BASELINE]
    if len(built.variants) > 1:
        level = _level(folder / built.processor)
    return [name for name, least in LEVELS.items() if name in built.variants and least <= level]


@cache
def _level(library: Path) -> int:
    try:
        return int(ctypes.CDLL(str(library)).certreg_level())
    except (OSError, AttributeError) as error:
        raise MissingLibraryError(f"{library} cannot be loaded ({error}): {REMEDY}") from error
