"""Mutants of the shipped formulas, and whether the derivations notice: `python tests/mutants.py`.

Each mutant changes one place of one file, in memory only; the claims named beside it, which are
about that formula, are proved anew about the mutated code. A mutant that every one of its claims
still proves has survived. One process is forked for each, so that none sees another's code.
"""

from __future__ import annotations

import importlib.abc
import importlib.machinery
import importlib.util
import json
import multiprocessing
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Mutant:
    """A change of `file` (from `old`, which stands there once, to `new`), and who must notice."""

    says: str
    file: str
    old: str
    new: str
    claims: tuple[str, ...]


SO3, MOTION = "certreg/geometry/so3.py", "derivations/motion.py"
CHECKER = "certreg/verify.py"
CLASSES = "certreg/objective/classification.py"
LINEAR, STEPS = "derivations/linearisation.py", "derivations/integrators.py"

MUTANTS = (
    Mutant(
        "transpose of C",
        SO3,
        "(a, b, c), (d, e, f), (g, h, i) = C",
        "(a, d, g), (b, e, h), (c, f, i) = C",
        ("davenport",),
    ),
    Mutant(
        "axial vector's sign",
        SO3,
        "(a + e + i, h - f, c - g, d - b),",
        "(a + e + i, f - h, c - g, d - b),",
        ("davenport",),
    ),
    Mutant(
        "trace with a minus",
        SO3,
        "(h - f, a - e - i, b + d, c + g),",
        "(h - f, a + e - i, b + d, c + g),",
        ("davenport",),
    ),
    Mutant(
        "off-diagonal difference",
        SO3,
        "(c - g, b + d, e - a - i, f + h),",
        "(c - g, b - d, e - a - i, f + h),",
        ("davenport",),
    ),
    Mutant(
        "rotation the other way",
        SO3,
        "2 * (x * y - w * z), 2 * (x * z + w * y)),",
        "2 * (x * y + w * z), 2 * (x * z + w * y)),",
        ("quaternions", "davenport"),
    ),
    Mutant(
        "diagonal of the rotation",
        SO3,
        "(ww + xx - yy - zz, 2 *",
        "(ww + xx + yy - zz, 2 *",
        ("quaternions", "davenport"),
    ),
    Mutant(
        "factor of the rotation",
        SO3,
        "2 * (y * z - w * x)),",
        "(y * z - w * x)),",
        ("quaternions", "davenport"),
    ),
    Mutant(
        "sign in the body frame",
        SO3,
        "((-x, -y, -z), (w, -z, y), (z, w, -x), (-y, x, w))",
        "((-x, -y, -z), (w, z, -y), (-z, w, x), (y, -x, w))",
        ("quaternions", "torque"),
    ),
    Mutant(
        "first row of the body frame",
        SO3,
        "((-x, -y, -z), (w, -z, y)",
        "((x, y, z), (w, -z, y)",
        ("quaternions", "torque"),
    ),
    Mutant(
        "spring factor",
        MOTION,
        "cloud.total(2 * (cloud.y - position(state, cloud.x)))",
        "cloud.total(cloud.y - position(state, cloud.x))",
        ("total_force", "euler_poincare"),
    ),
    Mutant(
        "force's sign",
        MOTION,
        "cloud.total(2 * (cloud.y - position(state, cloud.x)))",
        "cloud.total(2 * (position(state, cloud.x) - cloud.y))",
        ("total_force", "euler_poincare"),
    ),
    Mutant(
        "torque's sign",
        MOTION,
        "return cloud.total(cloud.x.cross(pull))",
        "return -cloud.total(cloud.x.cross(pull))",
        ("total_torque", "euler_poincare"),
    ),
    Mutant(
        "torque's factor",
        MOTION,
        "pull = 2 * (state.R.T",
        "pull = (state.R.T",
        ("total_torque", "euler_poincare"),
    ),
    Mutant(
        "torque without the transpose",
        MOTION,
        "2 * (state.R.T * (cloud.y - state.c)",
        "2 * (state.R * (cloud.y - state.c)",
        ("total_torque", "euler_poincare"),
    ),
    Mutant(
        "missing gyroscopic term",
        MOTION,
        "- drag - state.omega.cross(momentum)",
        "- drag",
        ("euler_poincare",),
    ),
    Mutant(
        "gyroscopic term's sign",
        MOTION,
        "- drag - state.omega.cross(momentum)",
        "- drag + state.omega.cross(momentum)",
        ("euler_poincare", "dalembert"),
    ),
    Mutant(
        "missing drag",
        MOTION,
        "spring_torque(state, cloud) - drag -",
        "spring_torque(state, cloud) -",
        ("euler_poincare", "dissipation"),
    ),
    Mutant(
        "damping of the wrong sign",
        MOTION,
        "force = spring_force(state, cloud) - damping",
        "force = spring_force(state, cloud) + damping",
        ("euler_poincare", "dissipation"),
    ),
    Mutant(
        "inertia's factor in the energy",
        MOTION,
        "return (cloud.mass * square(state.v) + rotational) / 2",
        "return cloud.mass * square(state.v) / 2 + rotational",
        ("kinetic_energy",),
    ),
    Mutant(
        "velocity from the wrong side",
        MOTION,
        "return state.R * state.omega.cross(x) + state.v",
        "return state.omega.cross(state.R * x) + state.v",
        ("kinetic_energy", "dalembert"),
    ),
    Mutant(
        "potential's factor",
        MOTION,
        "return square(state.c) + body.spread - 2 * inner(state.R, body.cross)",
        "return square(state.c) + body.spread - inner(state.R, body.cross)",
        ("potential_energy",),
    ),
    Mutant(
        "R' = [omega] R",
        MOTION,
        "*(state.R * hat(state.omega))",
        "*(hat(state.omega) * state.R)",
        ("ambient_jacobian", "euler_poincare", "pushforward"),
    ),
    Mutant(
        "damping not divided by J",
        MOTION,
        "- DAMPING * state.omega\n    return Matrix([*state.v",
        "- DAMPING * body.inertia * state.omega\n    return Matrix([*state.v",
        ("ambient_jacobian", "euler_poincare"),
    ),
    Mutant(
        "inertia is not the scatter",
        "derivations/moments.py",
        "return scatter.trace() * sympy.eye(3) - scatter",
        "return scatter",
        ("inertia", "kinetic_energy"),
    ),
    Mutant(
        "cross moment transposed",
        "derivations/moments.py",
        "return self.cross[b - 3, a]",
        "return self.cross[a, b - 3]",
        ("total_torque", "torque", "potential_energy"),
    ),
    Mutant(
        "Jacobian's spring block",
        LINEAR,
        "body.inertia_inverse * 2 * hat(",
        "body.inertia_inverse * hat(",
        ("ambient_jacobian",),
    ),
    Mutant(
        "Jacobian's turning block",
        LINEAR,
        "sympy.diag(*[-hat(state.omega)] * 3)",
        "sympy.diag(*[hat(state.omega)] * 3)",
        ("ambient_jacobian", "pushforward"),
    ),
    Mutant(
        "Jacobian's translation",
        LINEAR,
        "[-2 * eye(3), zeros(3, 9), -DAMPING * eye(3), zeros(3, 3)],",
        "[-eye(3), zeros(3, 9), -DAMPING * eye(3), zeros(3, 3)],",
        ("ambient_jacobian",),
    ),
    Mutant(
        "intrinsic spring's trace",
        LINEAR,
        "aligned - inner(state.R, body.cross) * eye(3))",
        "aligned + inner(state.R, body.cross) * eye(3))",
        ("intrinsic_jacobian", "pushforward"),
    ),
    Mutant(
        "intrinsic turning",
        LINEAR,
        "[zeros(3, 3), -hat(state.omega), zeros(3, 3), eye(3)],",
        "[zeros(3, 3), hat(state.omega), zeros(3, 3), eye(3)],",
        ("intrinsic_jacobian", "pushforward"),
    ),
    Mutant(
        "gyroscopic Jacobian",
        LINEAR,
        "hat(body.inertia * state.omega) - hat(state.omega) * body.inertia",
        "hat(body.inertia * state.omega)",
        ("ambient_jacobian", "intrinsic_jacobian"),
    ),
    Mutant(
        "Hessian's factor",
        LINEAR,
        "return 2 * inner(state.R, body.cross) * eye(3) - aligned",
        "return inner(state.R, body.cross) * eye(3) - aligned",
        ("hessian",),
    ),
    Mutant(
        "projection's second coefficient",
        STEPS,
        'naming("both", root * (root + 1))',
        'naming("both", root * root)',
        ("polar_projection",),
    ),
    Mutant(
        "projection's outer product",
        STEPS,
        "+ hat(sine) + share * Matrix(angle).T",
        "+ hat(sine) - share * Matrix(angle).T",
        ("polar_projection",),
    ),
    Mutant(
        "projection's first coefficient",
        STEPS,
        "return cosine * sympy.eye(3) + hat(sine)",
        "return sympy.eye(3) + hat(sine)",
        ("polar_projection",),
    ),
    Mutant(
        "quaternion torque's factor",
        STEPS,
        "return 2 * (L.T * (K * Matrix(q)))",
        "return L.T * (K * Matrix(q))",
        ("torque", "midpoint"),
    ),
    Mutant(
        "middle quaternion's norm",
        STEPS,
        "return 1 + step**2 * square(middle_omega) / 16",
        "return 1 + step**2 * square(middle_omega) / 4",
        ("midpoint",),
    ),
    Mutant(
        "middle velocity",
        STEPS,
        "(1 + step * DAMPING / 2 + step**2 / 2)",
        "(1 + step * DAMPING / 2 + step**2)",
        ("midpoint",),
    ),
    Mutant(
        "residual without the gyroscopic term",
        STEPS,
        "balance = quaternion_torque(middle_q, body) - middle.cross(momentum) -",
        "balance = quaternion_torque(middle_q, body) -",
        ("midpoint",),
    ),
    Mutant(
        "splitting's drift",
        STEPS,
        "return Matrix(q) + step / 2 *",
        "return Matrix(q) + step *",
        ("splitting",),
    ),
    Mutant(
        "splitting's kick",
        STEPS,
        "v = DECAY * state.v - 2 * IMPULSE * state.c",
        "v = DECAY * state.v - IMPULSE * state.c",
        ("splitting",),
    ),
    Mutant(
        "middle direction's quarter",
        STEPS,
        "return Matrix(q) + step / 4 * turn",
        "return Matrix(q) + step / 2 * turn",
        ("midpoint",),
    ),
    Mutant(
        "residual's half step",
        STEPS,
        "- step / 2 * balance",
        "- step * balance",
        ("midpoint",),
    ),
    Mutant(
        "residual's drag",
        STEPS,
        "- middle.cross(momentum) - DAMPING * momentum",
        "- middle.cross(momentum) + DAMPING * momentum",
        ("midpoint",),
    ),
    Mutant(
        "step to the middle only",
        STEPS,
        "q = 2 * middle_quaternion(state.q, middle_omega, step) - state.q",
        "q = middle_quaternion(state.q, middle_omega, step)",
        ("midpoint",),
    ),
    Mutant(
        "quaternion equations' gyroscopic term",
        STEPS,
        "turning = quaternion_torque(state.q, body) - state",
        "turning = quaternion_torque(state.q, body) + state",
        ("midpoint", "splitting"),
    ),
    Mutant(
        "speed of a turn",
        STEPS,
        "square(state.v) + 2 * square(state.omega)",
        "square(state.v) + square(state.omega)",
        ("splitting",),
    ),
    Mutant(
        "kick's gyroscopic term",
        STEPS,
        "torque = quaternion_torque(state.q, body) - state",
        "torque = quaternion_torque(state.q, body) + state",
        ("splitting",),
    ),
    Mutant(
        "Euler's centre with the new velocity",
        STEPS,
        "centre = state.c + step * state.v",
        "centre = state.c + step * (state.v + step * rates[12:15, :])",
        ("polar_projection", "euler_energy"),
    ),
    Mutant(
        "Euler's turn",
        STEPS,
        'turned = state.R * naming("turn", polar_turn(angle, root, naming))',
        'turned = naming("turn", polar_turn(angle, root, naming)) * state.R',
        ("polar_projection",),
    ),
    Mutant(
        "index off by one",
        CLASSES,
        "return (0, *accumulate(self.pattern[:-1]))",
        "return (1, *accumulate(self.pattern[:-1]))",
        ("classification", "morse_bott"),
    ),
    Mutant(
        "index counts the component itself",
        CLASSES,
        "return (0, *accumulate(self.pattern[:-1]))",
        "return tuple(accumulate(self.pattern))",
        ("classification", "morse_bott"),
    ),
    Mutant(
        "mirrored rows exchanged",
        CLASSES,
        "return (1, 3) if found.det > 0 else (3, 1)",
        "return (1, 3) if found.det < 0 else (3, 1)",
        ("classification",),
    ),
    Mutant(
        "sign of the cubic invariant",
        CLASSES,
        "if cubic_invariant < 0:",
        "if cubic_invariant > 0:",
        ("classification",),
    ),
    Mutant(
        "discriminant's coefficient",
        CLASSES,
        "- 18 * e1 * e2 + 27 * e3)",
        "- 18 * e1 * e2 + 4 * e3)",
        ("discriminant", "classification"),
    ),
    Mutant(
        "cubic invariant's coefficient",
        CLASSES,
        "- 9 * e1 * e2 + 27 * e3",
        "- 9 * e1 * e2 + 9 * e3",
        ("classification",),
    ),
    Mutant(
        "second invariant",
        CLASSES,
        "(e * i - f * h, f * g - d * i, d * h - e * g),",
        "(e * i + f * h, f * g - d * i, d * h - e * g),",
        ("classification", "discriminant"),
    ),
    Mutant(
        "rank one taken for rank two",
        CLASSES,
        "if found.e2 == 0:",
        "if found.det == 0:",
        ("classification",),
    ),
    Mutant(
        "best translation",
        "certreg/objective/isotropic.py",
        "end * norm << (b - common)) - (moved",
        "end * norm << (b - common)) + (moved",
        ("translation_gap", "maximum_likelihood"),
    ),
    Mutant(
        "an eighth of the spin",
        CHECKER,
        "Fraction(_form(J, w), 4)",
        "Fraction(_form(J, w), 8)",
        ("certified_basin",),
    ),
    Mutant(
        "another power of two",
        CHECKER,
        "_power(exponent) ** 2",
        "_power(exponent - 1) ** 2",
        ("certified_basin",),
    ),
    Mutant(
        "power of two not squared",
        CHECKER,
        "_power(exponent) ** 2",
        "_power(exponent)",
        ("certified_basin",),
    ),
    Mutant(
        "spin added",
        CHECKER,
        "- spin > level",
        "+ spin > level",
        ("certified_basin",),
    ),
    Mutant(
        "basin up to its boundary",
        CHECKER,
        "- spin > level",
        "- spin >= level",
        ("certified_basin",),
    ),
    Mutant(
        "alignment over another norm",
        CHECKER,
        "sum(c * c for c in p)",
        "sum(c * c for c in p[:3])",
        ("certified_basin",),
    ),
    Mutant(
        "rank-one term doubled",
        CHECKER,
        "Fraction(mu * a * b, square)",
        "Fraction(2 * mu * a * b, square)",
        ("optimality_certificate",),
    ),
    Mutant(
        "rank-one term over another norm",
        CHECKER,
        "Fraction(mu * a * b, square)",
        "Fraction(mu * a * b, 1 + square)",
        ("optimality_certificate",),
    ),
    Mutant(
        "level times the unit",
        CHECKER,
        "diagonal = level / unit",
        "diagonal = level",
        ("dual_bound",),
    ),
    Mutant(
        "K of the other sign",
        CHECKER,
        "rows[i][j] - K[i][j]",
        "rows[i][j] + K[i][j]",
        ("dual_bound",),
    ),
    Mutant(
        "an eliminated entry's sign",
        CHECKER,
        "below[j] * row[k] - below[k] * row[j]",
        "below[j] * row[k] - row[k] * row[j]",
        ("elimination",),
    ),
)


class _Patched(importlib.abc.MetaPathFinder, importlib.machinery.SourceFileLoader):
    """Imports one file with its source changed."""

    def __init__(self, mutant: Mutant) -> None:
        self.mutant = mutant
        if not (ROOT / mutant.file).is_file():
            raise FileNotFoundError(mutant.file)
        name = mutant.file.removesuffix(".py").replace("/", ".")
        super().__init__(name, str(ROOT / mutant.file))

    def find_spec(self, name, path=None, target=None):
        del path, target
        if name != self.name:
            return None
        return importlib.util.spec_from_file_location(name, self.path, loader=self)

    def get_code(self, fullname):
        text = Path(self.path).read_text()
        if text.count(self.mutant.old) != 1:
            raise ValueError(
                f"{self.mutant.says}: the text stands {text.count(self.mutant.old)} times"
            )
        mutated = text.replace(self.mutant.old, self.mutant.new)
        return compile(mutated, self.path, "exec")


def noticed(mutant: Mutant) -> str | None:
    """The claim that a mutant refutes, or whose proof it breaks; None if it survives."""
    sys.meta_path.insert(0, _Patched(mutant))
    from derivations import book
    from derivations.kernel import prove

    for name in mutant.claims:
        try:
            claim = book.claim(name)
            if not all(step.holds for step in claim.proof()):
                return name  # without the controls, which prove the same several times
            if not prove(claim).verdict.proved:
                return name
        except (TypeError, ValueError, ArithmeticError) as error:
            if "the text stands" in str(error):
                raise
            return f"{name} ({type(error).__name__})"
    return None


def main() -> None:
    """Print, as one JSON object, by whom each mutant was noticed."""
    import numpy as np
    import sympy

    assert np is not None
    assert sympy is not None  # imported once, before the forks
    context = multiprocessing.get_context("fork")
    with context.Pool(2, maxtasksperchild=1) as pool:
        answers = pool.map(noticed, MUTANTS, chunksize=1)
    found = {mutant.says: answer for mutant, answer in zip(MUTANTS, answers, strict=True)}
    sys.stdout.write(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    main()
