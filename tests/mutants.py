"""Mutants of the shipped formulas, and whether the derivations notice.

`PYTHONPATH=. python tests/mutants.py` prints who notices which.

Each mutant changes one place of one file, in memory only; the claims named beside it, which are
about that formula, are proved anew about the mutated code. A mutant that every one of its claims
still proves has survived. One process is forked for each, so that none sees another's code: there
the functions that differ get the code of the mutant, wherever they were imported before.
"""

from __future__ import annotations

import importlib
import inspect
import json
import os
import sys
import traceback
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import TYPE_CHECKING

from derivations import book
from derivations.kernel import prove

if TYPE_CHECKING:
    from collections.abc import Iterator


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
FORM, SPRINGS = "certreg/objective/form.py", "certreg/objective/springs.py"
QUARTIC, SPRING_BODY = "certreg/objective/quartics.py", "certreg/dynamics/valleys.py"
SPRING_MOTION, SPRING_STEPS = "derivations/spring_motion.py", "derivations/spring_integrators.py"
SPRING_REST = "derivations/claims/spring_rest.py"
LINEAR, STEPS = "derivations/linearisation.py", "derivations/integrators.py"
BREATHING = "derivations/breathing_motion.py"
BREATHING_STEPS = "derivations/breathing_integrators.py"
SCALING, SURE = "certreg/objective/scaling.py", "certreg/registration/covariance.py"
POINTS, NEIGHBOURHOOD = "certreg/objective/isotropic.py", "certreg/objective/neighbourhood.py"

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
        "hat(body.inertia * omega) - hat(omega) * body.inertia",
        "hat(body.inertia * omega)",
        ("ambient_jacobian", "intrinsic_jacobian"),
    ),
    Mutant(
        "breathing: half of the growth brakes",
        BREATHING,
        "(DAMPING + 2 * p / s) * omega\n    pull",
        "(DAMPING + p / s) * omega\n    pull",
        ("breathing_motion",),
    ),
    Mutant(
        "breathing: the spin of a step times the old scale",
        BREATHING_STEPS,
        "spin = body.inertia * (s * omega - state.scale * state.omega)",
        "spin = body.inertia * (state.scale * omega - state.scale * state.omega)",
        ("breathing_midpoint",),
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
        FORM,
        "[up * dot(row, r) for row",
        "[-up * dot(row, r) for row",
        ("translation_gap", "maximum_likelihood"),
    ),
    Mutant(
        "an eighth of the spin",
        CHECKER,
        "Fraction(quadratic(J, w), 4)",
        "Fraction(quadratic(J, w), 8)",
        ("certified_basin",),
    ),
    Mutant(
        "another power of two",
        CHECKER,
        "_dyadic(1, exponent) ** 2",
        "_dyadic(1, exponent - 1) ** 2",
        ("certified_basin",),
    ),
    Mutant(
        "power of two not squared",
        CHECKER,
        "_dyadic(1, exponent) ** 2",
        "_dyadic(1, exponent)",
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
        "a * b - n * k for b, k",
        "2 * a * b - n * k for b, k",
        ("optimality_certificate",),
    ),
    Mutant(
        "K times another norm",
        CHECKER,
        "n, along = sum(map(mul, q, q)) * unit",
        "n, along = (1 + sum(map(mul, q, q))) * unit",
        ("optimality_certificate",),
    ),
    Mutant(
        "level of the other sign",
        CHECKER,
        "row[i] += level",
        "row[i] -= level",
        ("dual_bound",),
    ),
    Mutant(
        "K of the other sign",
        CHECKER,
        "a * b - n * k for b, k",
        "a * b + n * k for b, k",
        ("dual_bound",),
    ),
    Mutant(
        "an eliminated entry's sign",
        CHECKER,
        "p * a - right[i] * b",
        "p * a - p * b",
        ("elimination",),
    ),
    Mutant(
        "an eliminated spring's sign",
        CHECKER,
        "(p * a - h[i] * b) // last",
        "(p * a + h[i] * b) // last",
        ("spring_translation",),
    ),
    Mutant(
        "free shifts counted where there are none",
        CHECKER,
        "free + (p == 0)",
        "free + (p != 0)",
        ("spring_translation",),
    ),
    Mutant(
        "unit over another pivot",
        CHECKER,
        "cls(F, _dyadic(1, e) / last, free",
        "cls(F, _dyadic(1, e) / last**2, free",
        ("spring_translation",),
    ),
    Mutant(
        "cost of a shift from another place",
        FORM,
        "- own * (whole // under)",
        "+ own * (whole // under)",
        ("spring_translation",),
    ),
    Mutant(
        "best shift over another norm",
        FORM,
        "down * self.determinant * over",
        "down * self.determinant",
        ("spring_translation",),
    ),
    Mutant(
        "products of two entries once",
        CHECKER,
        "s * t * (1 + (left is not right))",
        "s * t",
        ("quartic_relaxation",),
    ),
    Mutant(
        "what the free entries leave, with a plus",
        CHECKER,
        "left[monomial] -= G[i][j]",
        "left[monomial] += G[i][j]",
        ("quartic_relaxation",),
    ),
    Mutant(
        "diagonal of the Gram matrix once",
        CHECKER,
        "[2 * row[0], *row[1:]]",
        "[row[0], *row[1:]]",
        ("quartic_relaxation",),
    ),
    Mutant(
        "a product of the quartic once",
        "certreg/objective/quartics.py",
        "total[place] += multiple * entry",
        "total[place] += entry",
        ("quartic_relaxation",),
    ),
    Mutant(
        "traces of rows not taken off",
        SPRINGS,
        "total -= 3 * _weighed([e * e for e in rows]) + 3 *",
        "total -= 3 *",
        ("quartic_relaxation",),
    ),
    Mutant(
        "pairs of R added where they are taken off",
        SPRINGS,
        "2 * _entry(Q, a, b, j, k) + 2 * _entry(Q, a, b, k, j)",
        "2 * _entry(Q, a, b, j, k) - 2 * _entry(Q, a, b, k, j)",
        ("quartic_relaxation",),
    ),
    Mutant(
        "isotropic where the linear part vanishes",
        SPRINGS,
        "return self.part_sizes[1] == 0",
        "return self.part_sizes[0] == 0",
        ("quartic_relaxation",),
    ),
    Mutant(
        "unique at twice the gap",
        CHECKER,
        "4 * max(width, 2 * mu) * delta <= mu**2",
        "2 * max(width, 2 * mu) * delta <= mu**2",
        ("growth_form",),
    ),
    Mutant(
        "unique by a small width",
        CHECKER,
        "4 * max(width, 2 * mu) * delta",
        "4 * width * delta",
        ("growth_form",),
    ),
    Mutant(
        "half of a gap of growth",
        CHECKER,
        "require(stated.gap >= delta",
        "require(2 * stated.gap >= delta",
        ("growth_form",),
    ),
    Mutant(
        "half of an angle of growth",
        CHECKER,
        "0 < delta <= sin2 * mu",
        "0 < delta <= 2 * sin2 * mu",
        ("growth_form",),
    ),
    Mutant(
        "half of what the growth loses",
        CHECKER,
        "mu - 8 * k * X",
        "mu - 4 * k * X",
        ("growth_radius",),
    ),
    Mutant(
        "half of the slope",
        CHECKER,
        "4 * (k * (X + Y) + X * (fit + X + Y))",
        "2 * (k * (X + Y) + X * (fit + X + Y))",
        ("growth_radius",),
    ),
    Mutant(
        "no slope by the fit",
        CHECKER,
        "X * (fit + X + Y)",
        "X * (X + Y)",
        ("growth_radius",),
    ),
    Mutant(
        "the gap forgotten in the radius",
        CHECKER,
        "(steep * s - slope) * s >= delta",
        "(steep * s - slope) * s >= 0",
        ("growth_radius",),
    ),
    Mutant(
        "half of what roots move by",
        CHECKER,
        "delta + 4 * (X + Y) * (fit + (X + Y))",
        "delta + 2 * (X + Y) * (fit + (X + Y))",
        ("growth_radius",),
    ),
    Mutant(
        "roots of one cloud alone",
        CHECKER,
        "delta + 4 * (X + Y) * (fit + (X + Y))",
        "delta + 4 * Y * (fit + Y)",
        ("growth_radius",),
    ),
    Mutant(
        "the gap forgotten by the roots",
        CHECKER,
        "by_roots = mu * s * s >= delta + 4",
        "by_roots = mu * s * s >= 4",
        ("growth_radius",),
    ),
    Mutant(
        "both clouds, of which one moves",
        CHECKER,
        "keeps(both, both)",
        "keeps(Fraction(0), both)",
        ("growth_radius",),
    ),
    Mutant(
        "means of one and the same",
        CHECKER,
        "(now[at], now[at + 1])",
        "(now[at], now[at])",
        ("bernstein_cones",),
    ),
    Mutant(
        "the other half's order",
        CHECKER,
        "left[row[k]], right[row[degree - k]]",
        "left[row[k]], right[row[k]]",
        ("bernstein_cones",),
    ),
    Mutant(
        "first and last mean exchanged",
        CHECKER,
        "= now[0], now[-1], 35 + len(sums)",
        "= now[-1], now[0], 35 + len(sums)",
        ("bernstein_cones",),
    ),
    Mutant(
        "a curvature by another norm",
        CHECKER,
        "4 * norm**2 * (springs.at(c) + curvature)",
        "4 * norm * (springs.at(c) + curvature)",
        ("spring_caps",),
    ),
    Mutant(
        "the frame's sign",
        CHECKER,
        "frame = [-x, w, -z, y],",
        "frame = [-x, w, z, -y],",
        ("spring_caps",),
    ),
    Mutant(
        "a slope by another norm",
        CHECKER,
        "Fraction(square, 36 * norm**4)",
        "Fraction(square, 36 * norm**3)",
        ("spring_caps",),
    ),
    Mutant(
        "the mean not taken off",
        CHECKER,
        "abs(24 * c - k * mean)",
        "abs(24 * c)",
        ("spring_caps",),
    ),
    Mutant(
        "half of the range of a product",
        CHECKER,
        "size * (2 - (k > 0)) * min(16, times)",
        "size * min(16, times)",
        ("spring_caps",),
    ),
    Mutant(
        "caps twice as wide",
        CHECKER,
        "x = ratio / 16",
        "x = ratio / 8",
        ("spring_caps",),
    ),
    Mutant(
        "caps up to too small a cosine",
        CHECKER,
        "x**2 * (1 - x**2 / 3)",
        "x**2 * (1 + x**2 / 3)",
        ("spring_caps",),
    ),
    Mutant(
        "a level of caps rounded down",
        CHECKER,
        "-(-least.numerator // least.denominator)",
        "least.numerator // least.denominator",
        ("spring_caps",),
    ),
    Mutant(
        "half of the sine",
        CHECKER,
        "return Fraction(2 * n * isqrt(",
        "return Fraction(n * isqrt(",
        ("eigenvector_radius",),
    ),
    Mutant(
        "a cosine beyond one",
        CHECKER,
        "isqrt((d * d - n * n <<",
        "isqrt((d * d + n * n <<",
        ("eigenvector_radius",),
    ),
    Mutant(
        "the pose's own angle forgotten",
        CHECKER,
        "return g * (sine_below(s) - angle) / 2",
        "return g * sine_below(s) / 2",
        ("eigenvector_radius",),
    ),
    Mutant(
        "room of the whole gap",
        CHECKER,
        "return g * (sine_below(s) - angle) / 2",
        "return g * (sine_below(s) - angle)",
        ("eigenvector_radius",),
    ),
    Mutant(
        "separation at any level",
        CHECKER,
        "return proves_level(K, unit, q, level, 32",
        "return proves_level(K, unit, q, abs(level) + 99, 32",
        ("eigenvector_radius",),
    ),
    Mutant(
        "damping that drives a turn on general springs",
        SPRING_MOTION,
        "alpha = body.inertia_inverse * turning - DAMPING * state.omega",
        "alpha = body.inertia_inverse * turning + DAMPING * state.omega",
        ("spring_motion",),
    ),
    Mutant(
        "precession the other way on general springs",
        SPRING_MOTION,
        "turning = torque - state.omega.cross",
        "turning = torque + state.omega.cross",
        ("spring_motion",),
    ),
    Mutant(
        "a pull that grows with the turn",
        SPRING_MOTION,
        "return body.cross - shift(c, body) - turned(R, body)",
        "return body.cross - shift(c, body) + turned(R, body)",
        ("spring_motion",),
    ),
    Mutant(
        "half the torque of general springs",
        SPRING_MOTION,
        "2 * inner(pulled, R * axis) for axis in AXES",
        "inner(pulled, R * axis) for axis in AXES",
        ("spring_motion",),
    ),
    Mutant(
        "twice the force in the energy of general springs",
        SPRING_MOTION,
        "inner(state.c, force) / 2 - inner(pulled, state.R)",
        "inner(state.c, force) - inner(pulled, state.R)",
        ("spring_motion",),
    ),
    Mutant(
        "a trace with the other sign",
        SPRING_BODY,
        "of_points[p] * of_point + 3 *",
        "of_points[p] * of_point - 3 *",
        ("spring_motion",),
    ),
    Mutant(
        "the middle of a step at its end",
        SPRING_STEPS,
        "    c = state.c + step / 2 * middle.v\n    force",
        "    c = state.c + step * middle.v\n    force",
        ("spring_motion",),
    ),
    Mutant(
        "torque over twice the step",
        SPRING_STEPS,
        "(middle.omega - state.omega) - step / 2 * (torque",
        "(middle.omega - state.omega) - step * (torque",
        ("spring_motion",),
    ),
    Mutant(
        "a step of general springs without drag",
        SPRING_STEPS,
        "    force = spring_force(c, mean, body) - DAMPING * middle.v",
        "    force = spring_force(c, mean, body)",
        ("spring_motion",),
    ),
    Mutant(
        "minors with the other sign",
        CHECKER,
        "+= c if m[at] == j else -c",
        "+= c if m[at] == i else -c",
        ("forty_lines",),
    ),
    Mutant(
        "a chart that turns three of four factors",
        CHECKER,
        "for at in range(4):  # factor by factor",
        "for at in range(3):  # factor by factor",
        ("forty_lines",),
    ),
    Mutant(
        "lines in the plane at infinity",
        CHECKER,
        "for first, rank in (1, 45), (0, 80):",
        "for first, rank in ((0, 80),):",
        ("forty_lines",),
    ),
    Mutant(
        "a rank of 81 for 40 lines",
        CHECKER,
        "for first, rank in (1, 45), (0, 80):",
        "for first, rank in (1, 45), (0, 81):",
        ("forty_lines",),
    ),
    Mutant(
        "a gradient without multiples",
        QUARTIC,
        "q[variable] * sum(multiple * quartic[k]",
        "q[variable] * sum(quartic[k]",
        ("forty_lines",),
    ),
    Mutant(
        "twice the value of a quartic",
        QUARTIC,
        "        pairs[first] * sum(quartic[k]",
        "        2 * pairs[first] * sum(quartic[k]",
        ("spring_index",),
    ),
    Mutant(
        "second derivatives without multiples",
        QUARTIC,
        "        sum(multiple * quartic[k] * pairs[pair] for k",
        "        sum(quartic[k] * pairs[pair] for k",
        ("spring_index",),
    ),
    Mutant(
        "mixed second derivatives from the diagonal",
        QUARTIC,
        "entries[PAIR_PLACE[min(i, j), max(i, j)]] for j",
        "entries[PAIR_PLACE[max(i, j), max(i, j)]] for j",
        ("near_isotropy",),
    ),
    Mutant(
        "twice the second derivatives of a quartic",
        QUARTIC,
        "        sum(multiple * quartic[k] * pairs[pair] for k",
        "        sum(2 * multiple * quartic[k] * pairs[pair] for k",
        ("near_isotropy",),
    ),
    Mutant(
        "the energy over the norm",
        SPRINGS,
        "unit.numerator, norm**2 * unit.denominator)",
        "unit.numerator, norm * unit.denominator)",
        ("forty_real",),
    ),
    Mutant(
        "second derivatives with the other sign",
        QUARTIC,
        "        sum(multiple * quartic[k] * pairs[pair] for k",
        "        sum(-multiple * quartic[k] * pairs[pair] for k",
        ("forty_real",),
    ),
    Mutant(
        "second derivatives in one column twice",
        QUARTIC,
        "entries[PAIR_PLACE[min(i, j), max(i, j)]] for j in range(4))",
        "entries[PAIR_PLACE[min(i, j), max(i, j)]] for j in (0, 0, 2, 3))",
        ("real_lines",),
    ),
    Mutant(
        "a value of the other sign",
        QUARTIC,
        "        pairs[first] * sum(quartic[k]",
        "        -pairs[first] * sum(quartic[k]",
        ("real_lines",),
    ),
    Mutant(
        "springs that push the target away",
        FORM,
        "= -pulls[a][j] <<",
        "= pulls[a][j] <<",
        ("stable_spurious",),
    ),
    Mutant(
        "twice the spread of the target",
        FORM,
        "rows[0][0] = spread << 2 * there",
        "rows[0][0] = spread << 2 * there + 1",
        ("stable_spurious",),
    ),
    Mutant(
        "half the pull of a spring",
        SPRING_REST,
        "return 2 * factor * factor.T * stretched",
        "return factor * factor.T * stretched",
        ("spring_rest",),
    ),
    Mutant(
        "a spring by the transposed factor",
        SPRING_REST,
        "return 2 * factor * factor.T * stretched",
        "return 2 * factor.T * factor * stretched",
        ("spring_rest",),
    ),
    Mutant(
        "a scale over the target",
        SCALING,
        "return max(alignment, Fraction(0)) / self.source",
        "return max(alignment, Fraction(0)) / self.target",
        ("scale_elimination",),
    ),
    Mutant(
        "a best scale below 0",
        SCALING,
        "return max(alignment, Fraction(0)) / self.source",
        "return alignment / self.source",
        ("scale_elimination",),
    ),
    Mutant(
        "an alignment below 0 that lowers the energy",
        SCALING,
        "return self.target - max(alignment, Fraction(0)) ** 2",
        "return self.target - alignment**2",
        ("scale_elimination",),
    ),
    Mutant(
        "an energy without the cross term",
        SCALING,
        "squares = self.target - 2 * scale * alignment +",
        "squares = self.target +",
        ("scale_elimination",),
    ),
    Mutant(
        "a symmetric energy not over the scale",
        SCALING,
        "return squares / self.divisor(scale)",
        "return squares",
        ("scale_elimination",),
    ),
    Mutant(
        "a gap without the square of delta",
        SCALING,
        "return delta * (2 * alignment + delta) / self.source",
        "return delta * 2 * alignment / self.source",
        ("scale_elimination",),
    ),
    Mutant(
        "half the symmetric gap",
        SCALING,
        "return 2 * delta",
        "return delta",
        ("scale_elimination",),
    ),
    Mutant(
        "an interval of delta / 2",
        SCALING,
        "(alignment + delta) / self.source\n",
        "(alignment + delta / 2) / self.source\n",
        ("scale_elimination",),
    ),
    Mutant(
        "a scale of variance 1 / Syy",
        POINTS,
        "for entry in m.source_scatter[j]]",
        "for entry in m.target_scatter[j]]",
        ("scale_covariance",),
    ),
    Mutant(
        "a shift with the scale the other way",
        POINTS,
        "-m.source_sum[j] << here",
        "m.source_sum[j] << here",
        ("scale_covariance",),
    ),
    Mutant(
        "a covariance of turns without the scale",
        NEIGHBOURHOOD,
        "turns = (scale * CROSSES",
        "turns = (CROSSES",
        ("scale_covariance",),
    ),
    Mutant(
        "half the covariance of turns and scale",
        SURE,
        "rows = 2 * weight.numerator",
        "rows = weight.numerator",
        ("scale_covariance",),
    ),
    Mutant(
        "a form in a box that does not bend",
        CHECKER,
        "curved = 3 * h * (max(spare + slack, 0) << CHORD)",
        "curved = 0",
        ("truncated_survey",),
    ),
    Mutant(
        "a reach without the diagonal of the box",
        CHECKER,
        "reach = isqrt((12 * min(u, v) << UNITS)",
        "reach = isqrt((4 * min(u, v) << UNITS)",
        ("truncated_survey",),
    ),
    Mutant(
        "a form that is not lowered",
        CHECKER,
        "slack = [3 * (i == j) for i, j in PRODUCTS]",
        "slack = [-3 * (i == j) for i, j in PRODUCTS]",
        ("truncated_survey",),
    ),
    Mutant(
        "outliers whatever their label",
        CHECKER,
        'out, fits = out + 1, fits and labels[k] != "1"',
        "out, fits = out + 1, fits",
        ("truncated_survey",),
    ),
    Mutant(
        "the bound of one pair for the sum of two",
        CHECKER,
        "D = A + B - (u + v) ** 2",
        "D = A + B - u**2",
        ("pair_lengths",),
    ),
    Mutant(
        "lengths that differ by a bound, and D below 0",
        CHECKER,
        "if D <= 0 or D * D <= 4 * A * B:",
        "if D * D <= 4 * A * B:",
        ("pair_lengths",),
    ),
    Mutant(
        "a length without its last coordinate",
        CHECKER,
        "+ (h - q) ** 2",
        "",
        ("pair_lengths",),
    ),
    Mutant(
        "K neighbours asked for",
        CHECKER,
        "(self.near[i] & alive).bit_count() < self.K - 1",
        "(self.near[i] & alive).bit_count() < self.K",
        ("few_neighbours",),
    ),
    Mutant(
        "neighbours of one colour",
        CHECKER,
        "free &= ~(near[low.bit_length() - 1] | low)",
        "free &= near[low.bit_length() - 1]",
        ("few_colours",),
    ),
    Mutant(
        "a row more that is left out",
        CHECKER,
        "union.bit_count() + others - room - 1",
        "union.bit_count() + others - room - 2",
        ("weighted_refutation",),
    ),
    Mutant(
        "a clique that holds a group",
        CHECKER,
        "rows &= ~sum({T for T in left if T & (T - 1) == 0})",
        "rows &= -1",
        ("cliques_without_groups",),
    ),
    Mutant(
        "bounds that are not squared",
        CHECKER,
        "bound += w * row[7] ** 2",
        "bound += w * row[7]",
        ("weighted_refutation",),
    ),
    Mutant(
        "a row that counts for two",
        CHECKER,
        "if not T & low], most - 1, 0, 0",
        "if not T & low], most - 2, 0, 0",
        ("weighted_refutation",),
    ),
    Mutant(
        "K once, where it stands twice",
        CHECKER,
        "raised([[-2 * k for k in row] for row in K]",
        "raised([[-k for k in row] for row in K]",
        ("weighted_refutation",),
    ),
    Mutant(
        "turns about a line that does not tilt",
        CHECKER,
        "tilt = isqrt(",
        "tilt = 0 * isqrt(",
        ("arcs",),
    ),
    Mutant(
        "an arc whatever lies along the line",
        CHECKER,
        "- reach * reach - 2 * x[2] * y[2]",
        "- reach * reach",
        ("arcs",),
    ),
    Mutant(
        "a reach of twice the squared sine",
        CHECKER,
        "a * size * (d - s.numerator)",
        "a * size * (d - 2 * s.numerator)",
        ("angle_of_consensus",),
    ),
    Mutant(
        "an inlier without which K pairs are left",
        CHECKER,
        "sure |= (left.bit_count() < K) << i",
        "sure |= (left.bit_count() <= K) << i",
        ("consensus_labels",),
    ),
    Mutant(
        "a maximum below the pairs that are left",
        CHECKER,
        "min(upper, max(k - 1, left.bit_count()))",
        "min(upper, k - 1)",
        ("consensus_labels",),
    ),
)
UNCHANGED = Mutant("unchanged", SO3, MUTANTS[0].old, MUTANTS[0].old, ("davenport",))


def change(mutant: Mutant) -> None:
    """Put a mutant in the place of the code that is loaded.

    Raises ValueError where its text does not stand once, or does not stand within a function.
    """
    text = (ROOT / mutant.file).read_text("utf-8")
    if text.count(mutant.old) != 1:
        raise ValueError(f"{mutant.says}: the text stands {text.count(mutant.old)} times")
    module = importlib.import_module(mutant.file.removesuffix(".py").replace("/", "."))
    loaded = functions(module)
    for name, code in changed_functions(text, text.replace(mutant.old, mutant.new)):
        loaded[name].__code__ = code


def changed_functions(text: str, mutated: str) -> Iterator[tuple[str, CodeType]]:
    """The functions and methods that differ, by qualified names, with the code of the mutant."""
    old, new = (outermost(compile(each, "mutant", "exec")) for each in (text, mutated))
    if old.keys() != new.keys():
        raise ValueError("the mutant has other functions")
    differing = [name for name, code in old.items() if not same(code, new[name])]
    if text != mutated and not differing:
        raise ValueError("the mutant changes no function")
    return ((name, new[name]) for name in differing)


def outermost(code: CodeType) -> dict[str, CodeType]:
    """The functions of a module and the methods of its classes; what is within them goes along."""
    found: dict[str, CodeType] = {}
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            is_function = inner.co_flags & inspect.CO_OPTIMIZED
            found |= {inner.co_qualname: inner} if is_function else outermost(inner)
    return found


def same(one: CodeType, other: CodeType) -> bool:
    """Whether two pieces of code do the same, wherever they stand in their files."""
    return _meaning(one) == _meaning(other)


def _meaning(code: CodeType) -> tuple[object, ...]:
    constants = (
        _meaning(each) if isinstance(each, CodeType) else (type(each), each)
        for each in code.co_consts
    )
    return (code.co_code, code.co_names, code.co_varnames, *constants)


def functions(holder: ModuleType | type) -> dict[str, FunctionType]:
    """The functions that a module or a class defines, by qualified names."""
    home = holder.__name__ if isinstance(holder, ModuleType) else holder.__module__
    found: dict[str, FunctionType] = {}
    for value in vars(holder).values():
        if isinstance(value, type) and value.__module__ == home and value is not holder:
            found |= functions(value)
        inner = inspect.unwrap(getattr(value, "fget", None) or getattr(value, "func", value))
        inner = getattr(inner, "__func__", inner)
        if isinstance(inner, FunctionType) and inner.__module__ == home:
            found[inner.__qualname__] = inner
    return found


def noticed(mutant: Mutant) -> str | None:
    """The claim that a mutant refutes, or whose proof it breaks; None if it survives."""
    change(mutant)
    for name in mutant.claims:
        try:
            claim = book.claim(name)
            if not all(step.holds for step in claim.proof()):
                return name  # without the controls, which prove the same several times
            if not prove(claim).verdict.proved:
                return name
        except (TypeError, ValueError, ArithmeticError) as error:
            return f"{name} ({type(error).__name__})"
    return None


def noticed_apart(mutant: Mutant) -> str | None:
    """As `noticed`, in a process forked for it."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(writing, json.dumps(noticed(mutant)).encode())
        except BaseException:  # noqa: BLE001 - nothing may leave a forked process
            os.write(2, traceback.format_exc().encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, encoding="utf-8") as answer:
        text = answer.read()
    os.waitpid(child, 0)
    if not text:
        raise RuntimeError(f"nobody could be asked about the mutant: {mutant.says}")
    return json.loads(text)


def main() -> None:
    """Print, as one JSON object, by whom each mutant was noticed."""
    book.claims()  # loaded once, before the forks
    answers = {mutant.says: noticed_apart(mutant) for mutant in (UNCHANGED, *MUTANTS)}
    sys.stdout.write(json.dumps(answers, indent=1) + "\n")


if __name__ == "__main__":
    main()
