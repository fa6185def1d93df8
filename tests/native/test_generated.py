"""The committed code is what the derivations say, and it computes what the points say."""

from __future__ import annotations

import json
import math
import subprocess
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import sympy
from engines import c_compiler
from engines import engine as either
from reference_engine import of_arrays, reference

from certreg.dynamics.rigid import rigid_body
from certreg.dynamics.simulation import simulate
from certreg.dynamics.states import start_at_rest
from certreg.io.atomic import write_files
from certreg.native.codegen.emit import generated_files
from certreg.native.codegen.translate import Definition, casadi_function, port
from certreg.native.kernels import GENERATED
from certreg.native.library import Library
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.registration.c_sources import write_sources
from certreg.registration.examples import STORIES, stated
from derivations import emit as chain
from derivations import motion

if TYPE_CHECKING:
    from collections.abc import Iterable

NAMES = ("dynamics.c", "dynamics.h", "layout.h", "layout.json", "signatures.json")
FILES = {
    edition: {f"{begun}{name}" for name in NAMES}
    for edition, begun in (("rigid", ""), ("breathing", "breathing_"), ("springs", "spring_"))
}


def library_or_skip() -> Library:
    found = either("library")
    assert isinstance(found, Library)
    return found


@pytest.fixture(scope="module")
def definitions() -> tuple[Definition, ...]:
    return chain.definitions()


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("edition", FILES)
def test_generating_anew_gives_the_committed_bytes(edition):
    made = chain.EDITIONS[edition]()

    assert made.keys() == FILES[edition]
    for name, content in made.items():
        assert content == (GENERATED / name).read_bytes(), name


def test_every_file_that_is_committed_is_generated():
    kept = {path.name for path in GENERATED.iterdir() if path.is_file()}

    assert chain.EDITIONS.keys() == FILES.keys()
    assert {name for names in FILES.values() for name in names} == kept


@pytest.mark.slow
def test_a_mutated_derivation_changes_the_code(tmp_path, monkeypatch):
    honest = motion.spring_torque
    monkeypatch.setattr(motion, "spring_torque", lambda state, cloud: -honest(state, cloud))

    write_files(tmp_path, generated_files(chain.definitions(), chain.records()))

    assert (tmp_path / "dynamics.c").read_bytes() != (GENERATED / "dynamics.c").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["certreg_rate", "certreg_euler_step"])
def test_python_gives_the_bits_of_casadi(name, definitions):
    definition = next(each for each in definitions if each.name == name)
    function, call = casadi_function(definition), reference().calls[name]
    rng = np.random.default_rng(6)
    many = [rng.normal(size=(len(port.entries), 5)) for port in definition.arguments]
    together = of_arrays(call.tape, many)
    for k in range(5):
        numbers = [argument[:, k] for argument in many]
        expected = [value.elements() for value in function.call([n.tolist() for n in numbers])]
        for one, other, wanted in zip(call(*numbers), together, expected, strict=True):
            assert one.tobytes() == other[:, k].tobytes() == np.array(wanted).tobytes()


def test_where_c_has_infinity_or_no_number_the_evaluator_has_the_same():
    compiled, beyond = library_or_skip(), 0
    for name, shape in compiled.shapes.items():
        for value in (0.0, -1.0, math.nan):  # of zeros, the splitting step divides by zero
            arguments = [np.full(size, value) for size in shape.arguments]
            one, other = (each.evaluate(name, *arguments) for each in (compiled, reference()))
            beyond += value == 0.0 and any(np.isnan(mine).any() for mine in one)
            for mine, theirs in zip(one, other, strict=True):
                assert (np.isnan(mine) == np.isnan(theirs)).all(), name
                assert (np.isposinf(mine) == np.isposinf(theirs)).all(), name

    assert beyond


@pytest.mark.parametrize(
    "name",
    sorted(
        name
        for file in ("signatures.json", "breathing_signatures.json", "spring_signatures.json")
        for name in json.loads((GENERATED / file).read_text("utf-8"))
    ),
)
def test_the_compiled_code_and_the_evaluator_agree(name):
    rng = np.random.default_rng(3)
    compiled, interpreted = library_or_skip(), reference()
    for _ in range(20):
        arguments = [rng.normal(size=n) for n in compiled.shapes[name].arguments]
        pairs = zip(
            compiled.evaluate(name, *arguments), interpreted.evaluate(name, *arguments), strict=True
        )
        for one, other in pairs:
            assert np.abs(one - other).max() <= 1e-12 * max(1.0, np.abs(other).max())


def test_a_wrong_size_is_refused_by_both_engines():
    for engine in (library_or_skip(), reference()):
        with pytest.raises(ValueError, match="certreg_rate takes"):
            engine.evaluate("certreg_rate", np.zeros(17), np.zeros(23))


def test_an_expression_beyond_arithmetic_is_refused():
    x = sympy.Symbol("x")
    powers = (x ** sympy.Rational(1, 3), x ** sympy.Rational(1, 4), x ** sympy.Rational(-3, 4))
    for expression in (sympy.sin(x), *powers, sympy.Symbol("unknown")):
        definition = Definition(
            name="f", says="", arguments=(port("x", [x]),), results=(port("y", [expression]),)
        )
        with pytest.raises(TypeError, match=r"arithmetic|power"):
            casadi_function(definition)


def values_of(expressions: Iterable[Any], numbers: dict[Any, float]) -> list[float]:
    function = sympy.lambdify(list(numbers), list(expressions), "math")
    return function(*numbers.values())


@pytest.mark.long
def test_named_values_are_those_of_the_derived_step():
    from derivations import integrators

    euler = next(d for d in chain.definitions() if d.name == "certreg_euler_step")
    whole = dict(euler.named)
    state, body = motion.State(), motion.Body()
    rng = np.random.default_rng(8)
    numbers = {s: float(rng.normal()) for s in (*state.flat, *body.flat, integrators.STEP)}

    for symbol, value in whole.items():
        (numbers[symbol],) = values_of([value], numbers)
    found = values_of(euler.results[0].entries, numbers)
    expected = values_of(integrators.euler_step(state, body), numbers)

    assert len(whole) >= 20
    assert np.allclose(found, expected, rtol=1e-12)


def test_terms_with_equal_coefficients_are_multiplied_once():
    a, b, c = sympy.symbols("a b c")
    given = (port("x", [a, b, c]),)
    function = casadi_function(
        Definition(
            name="f",
            says="",
            arguments=given,
            results=(port("y", [3 * a - 3 * b - c / 2 - 5, -a - 2 * b, -2 * a - 2 * b]),),
        )
    )

    assert str(function).startswith("f:(x[3])->(y[3])")
    assert np.allclose(function([7.0, 2.0, 4.0]).full().ravel(), [8.0, -11.0, -18.0])
    import casadi

    operations = [function.instruction_id(k) for k in range(function.n_instructions())]
    assert operations.count(casadi.OP_MUL) == 4  # 3 (a - b), c / 2, 2 b, 2 (a + b)


def test_an_euler_step_divides_once():
    text = (GENERATED / "dynamics.c").read_text("utf-8")
    start = text.index("void certreg_euler_step")
    end = text.index("void certreg_quaternion_energies")

    assert text[start:end].count("/") == 1


@pytest.mark.slow
def test_the_sources_to_embed_compile_without_a_warning_and_reproduce_a_trajectory(tmp_path):
    paths = write_sources(tmp_path / "embedded")
    folder = tmp_path / "embedded"
    compiler = c_compiler()
    flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    units = [str(folder / name) for name in ("example.c", "dynamics.c")]

    built = subprocess.run(
        [*compiler, *flags, *units, "-lm", "-o", str(folder / "example")],
        capture_output=True,
        text=True,
        check=False,
        encoding="utf-8",
    )
    assert (built.returncode, built.stderr) == (0, "")
    run = subprocess.run(
        [str(folder / "example")],
        input=(folder / "survey.txt").read_text("utf-8"),
        capture_output=True,
        text=True,
        check=True,
        encoding="utf-8",
    )
    steps, *state = run.stdout.split()
    trajectory = simulate(Isotropic(exact_moments(stated(STORIES[0]))), stated(STORIES[0]).damping)

    assert {path.name for path in paths} == {"dynamics.c", "dynamics.h", "example.c", "survey.txt"}
    assert int(steps) == trajectory.steps
    assert np.allclose(np.array(state, dtype=float), trajectory.states[-1], atol=1e-12)


@pytest.mark.slow
def test_the_example_says_what_it_expects(tmp_path):
    write_sources(tmp_path)
    compiler = c_compiler()
    units = [str(tmp_path / name) for name in ("example.c", "dynamics.c")]
    subprocess.run([*compiler, *units, "-lm", "-o", str(tmp_path / "example")], check=True)

    run = subprocess.run(
        [str(tmp_path / "example")],
        input="1 2 3",
        capture_output=True,
        text=True,
        check=False,
        encoding="utf-8",
    )

    assert run.returncode == 2
    assert "expected 44 numbers" in run.stderr


@pytest.mark.parametrize("seed", range(5))
def test_the_jacobians_are_the_derivatives_of_the_rates(seed):
    rng = np.random.default_rng(seed)
    moving = rigid_body(exact_moments(stated(STORIES[seed % 3])), 1.3)
    state = start_at_rest(exact_moments(stated(STORIES[seed % 3])), moving.length_exponent)
    state = state + rng.normal(size=18)
    step = 1e-6

    numeric = np.array(
        [
            (moving.rate(state + step * e) - moving.rate(state - step * e)) / (2 * step)
            for e in np.eye(18)
        ]
    ).T

    found = moving.ambient_jacobian(state)
    assert np.abs(numeric - found).max() < 1e-7 * max(1.0, np.abs(found).max())


@pytest.mark.parametrize("twice", [-6, -5, -3, -2, -1, 1, 2, 3, 5, 6])
def test_whole_and_half_powers_are_those_of_the_number(twice):
    x = sympy.Symbol("x")
    expression = x ** sympy.Rational(twice, 2)
    power = casadi_function(
        Definition(
            name="f", says="", arguments=(port("x", [x]),), results=(port("y", [expression]),)
        )
    )

    assert float(power(1.7)) == pytest.approx(1.7 ** (twice / 2), rel=1e-14)
