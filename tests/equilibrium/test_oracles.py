"""Three other programs solve the same quadratics: the same number of roots, and the same roots.

Singular and PHCpack are found on PATH, msolve there or in the folder CERTREG_ORACLES, which
`make test-oracles` sets after it has installed all three; then a missing program is a failure.
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
from fractions import Fraction

import numpy as np
import pytest
import spring_families
import strategies
from oracles.exports import as_msolve, as_phcpack, as_singular, value_unit
from oracles.polynomials import multiplier_system
from oracles.systems import line_system, quaternion_system, rotation_system

from certreg.equilibrium.equilibrium_set import unit_double
from certreg.equilibrium.groebner import eliminate, fibres
from certreg.equilibrium.line_set import LineSet
from certreg.equilibrium.methods import search
from certreg.geometry.so3 import davenport_matrix, rotation_matrix
from certreg.objective.springs import Springs
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

FOLDER = os.environ.get("CERTREG_ORACLES")
SEEDS = range(12)
ANGLE = 1e-10
FAR = 1e3  # of the 64 paths of PHCpack 24 go to infinity, and are stopped on the way


def program(name):
    found = shutil.which(name) or shutil.which(name, path=FOLDER)
    if found is None and FOLDER is None:
        pytest.skip(f"{name} is not installed: make test-oracles")
    assert found is not None, f"{name} is not installed"
    return found


def told(words, text=None):
    done = subprocess.run(
        words, input=text, capture_output=True, text=True, check=True, timeout=60, encoding="utf-8"
    )
    return done.stdout


def generic(seed):
    """A random problem; its C is integer, of some hundred bits."""
    problem = strategies.random_problem(np.random.default_rng(seed), noise=10.0 ** (seed % 3 - 1))
    return exact_moments(problem).cross


def ours(C):
    """The four unit quaternions (4, 4), w first and positive."""
    parts = fibres(eliminate(C, davenport_matrix(C)), 100)
    q = np.array([[float(c.mid()) for c in part.vectors[0]] for part in parts])
    return q * np.sign(q[:, :1])


def assert_same(found, C):
    """Each root of the other program is one of ours, and each of ours is one of them."""
    found = np.array(found, dtype=float)
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    found *= np.sign(found[:, :1])
    distance = np.linalg.norm(found[:, None] - ours(C)[None], axis=2)
    assert found.shape == (4, 4)
    assert distance.min(axis=0).max() < ANGLE
    assert distance.min(axis=1).max() < ANGLE


def real_roots(answer):
    """The middles of the intervals in three unknowns that msolve prints."""
    pairs = re.findall(r"\[(-?\d+)(?: / 2\^(\d+))?, (-?\d+)(?: / 2\^(\d+))?\]", answer)
    middles = [
        float(Fraction(int(a), 2 ** int(b or 0)) + Fraction(int(c), 2 ** int(d or 0))) / 2
        for a, b, c, d in pairs
    ]
    assert answer.startswith("[0, [1,")
    return np.array(middles).reshape(-1, 3)


@pytest.mark.parametrize("seed", SEEDS)
def test_singular_counts_four_solutions_in_the_entries_of_R_and_in_the_chart(seed):
    singular, C = program("Singular"), generic(seed)
    for system in (rotation_system(C), quaternion_system(C, chart=True)):
        text = as_singular(system) + "ideal G = groebner(I);\ndim(G);\nvdim(G);\nquit;\n"
        assert told([singular, "-q"], text).split() == ["0", "4"]


@pytest.mark.parametrize("seed", SEEDS)
def test_singular_finds_the_same_roots(seed):
    singular, C = program("Singular"), generic(seed)
    text = 'LIB "solve.lib";\n' + as_singular(quaternion_system(C, chart=True))
    text += 'def s = solve(I, 30, "nodisplay");\nsetring s;\nprint(SOL);\nquit;\n'
    answer = told([singular, "-q"], text)
    numbers = re.findall(r"^\s*(-?[\d.]+(?:e[+-]?\d+)?)\s*$", answer, re.MULTILINE)
    roots = np.array(numbers, dtype=float).reshape(-1, 3)

    assert_same(np.hstack([np.ones((len(roots), 1)), roots]), C)


@pytest.mark.parametrize("specimen", strategies.ZOO, ids=lambda s: s.name)
def test_singular_finds_dimension_and_degree_of_every_row(specimen):
    """The components in the entries of R: points, conics, Veronese surfaces, SO(3)."""
    singular, C = program("Singular"), exact_moments(specimen.problem).cross
    text = as_singular(rotation_system(C)) + 'LIB "primdec.lib";\nideal G = groebner(I);\n'
    text += "dim(G);\nmult(G);\nlist L = minAssGTZ(I);\nint k;\n"
    text += "for (k = 1; k <= size(L); k++) { dim(std(L[k])); mult(std(L[k])); }\nquit;\n"
    answer = told([singular, "-q"], text)
    numbers = [int(line) for line in answer.splitlines() if re.fullmatch(r"-?\d+", line)]
    dimension, degree, *components = numbers
    parts = fibres(eliminate(C, davenport_matrix(C)), 60)

    assert dimension == max(part.dimension for part in parts)
    assert degree == sum(part.degree for part in parts if part.dimension == dimension)
    # over Q conjugate components come together: the degrees of each dimension add up
    for d in range(4):
        theirs = sum(m for k, m in zip(components[::2], components[1::2], strict=True) if k == d)
        assert theirs == sum(part.degree for part in parts if part.dimension == d)


@pytest.mark.parametrize("seed", SEEDS)
def test_msolve_isolates_the_same_four_real_roots(seed, tmp_path):
    msolve, C = program("msolve"), generic(seed)
    file = tmp_path / "system.ms"
    file.write_text(as_msolve(quaternion_system(C, chart=True)), "utf-8")
    roots = real_roots(told([msolve, "-f", str(file), "-o", "/dev/stdout", "-p", "100"]))

    assert_same(np.hstack([np.ones((len(roots), 1)), roots]), C)


@pytest.mark.parametrize("seed", SEEDS)
def test_phcpack_finds_the_same_four_roots(seed, tmp_path):
    phc, C = program("phc"), generic(seed)
    source, target = tmp_path / "system", tmp_path / "solutions"
    source.write_text(
        as_phcpack(multiplier_system(davenport_matrix(C), unit=value_unit(C))), "utf-8"
    )
    told([phc, "-b", f"-0{seed + 1}", str(source), str(target)])
    text = target.read_text("utf-8")
    text = text[text.rindex("THE SOLUTIONS") :]
    roots = [
        [float(re.search(rf"^ {name} :\s+(\S+)\s", block, re.MULTILINE)[1]) for name in "wxyz"]  # pyright: ignore[reportOptionalSubscript]
        for block in text.split("the solution for t :")[1:]
    ]

    assert_same(roots, C)


def springs(seed):
    """Random general springs, of doubles: coefficients of 600 bits; and the list of equilibria."""
    if FOLDER is None:
        pytest.skip("half a minute each: make test-oracles")
    cell = spring_families.LISTED[seed % len(spring_families.LISTED)]
    stated = spring_families.statement(spring_families.instance(cell, seed))
    objective = Springs.of(RegistrationProblem(**stated))
    found = search(objective, "homotopy").critical
    assert isinstance(found, LineSet)
    return objective.quartic, found


@pytest.mark.parametrize("seed", range(20))
def test_msolve_isolates_as_many_equilibria_of_general_springs_and_the_same(seed, tmp_path):
    msolve, (quartic, found) = program("msolve"), springs(seed)
    file = tmp_path / "system.ms"
    file.write_text(as_msolve(line_system(quartic)), "utf-8")
    roots = real_roots(told([msolve, "-f", str(file), "-o", "/dev/stdout", "-p", "100"]))
    theirs = np.hstack([np.ones((len(roots), 1)), roots])
    theirs /= np.linalg.norm(theirs, axis=1, keepdims=True)
    ours = np.array([unit_double(part.quaternion) for part in found.components])
    across = 1.0 - np.abs(theirs @ ours.T)

    assert found.complete
    assert len(theirs) == len(ours)
    assert across.min(axis=0).max() < 1e-14
    assert across.min(axis=1).max() < 1e-14


@pytest.mark.parametrize("seed", range(3))
def test_singular_and_phcpack_count_forty_critical_lines_of_general_springs(seed, tmp_path):
    singular, phc, (quartic, _) = program("Singular"), program("phc"), springs(seed)
    system = line_system(quartic)
    text = as_singular(system) + "ideal G = groebner(I);\ndim(G);\nvdim(G);\nquit;\n"
    source, target = tmp_path / "system", tmp_path / "solutions"
    source.write_text(as_phcpack(system), "utf-8")
    told([phc, "-b", f"-0{seed + 1}", str(source), str(target)])
    answer = target.read_text("utf-8")
    blocks = answer[answer.rindex("THE SOLUTIONS") :].split("the solution for t :")[1:]
    entries = [re.findall(r"^ [xyz] :\s+(\S+)\s+(\S+)", block, re.MULTILINE) for block in blocks]
    sizes = [max(math.hypot(float(a), float(b)) for a, b in found) for found in entries]

    assert told([singular, "-q"], text).split() == ["0", "40"]
    assert sum(size < FAR for size in sizes) == 40


def test_the_rotations_of_the_roots_are_rotations():
    for q in ours(generic(0)):
        R = np.array(rotation_matrix(q.tolist()))
        assert np.abs(R @ R.T - np.eye(3)).max() < 1e-14
