"""Springs that turn about the origin: optimum, noise and forgeries, against SciPy's least squares.

    make rates NAME=turned_springs ARGS="[INSTANCES [NOISES [FORGERIES]]]"

Planes, lines and covariances in turn. The optimum is held to the best of many descents by SciPy
from random rotations, each certificate to `python3 -I -S certreg/verify.py`, and the variance
factors to their mean, 1. A forgery is a certificate with another pose, other data or another
motion, of which SciPy finds a claim false. A part of it is in the tests.
"""

from __future__ import annotations

import base64
import hashlib
import json
import struct
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

import certreg
from certreg.verify import check

INSTANCES, NOISES, FORGERIES = 200, 1000, 600
CHECKER = str(Path(certreg.__file__).with_name("verify.py"))
KINDS = ("normals", "directions", "covariances")
STARTS = 12  # random rotations
AS_GOOD = 1e-12  # of the cost
TIGHT: Any = {"jac": "3-point", "xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
FALSE = 1e-9  # of the energy at the pose: what a claim must be off by to be called false
NOISE = 0.01
PREFIXES = b"certreg-springs/1\0", b"certreg-springs-rotation/1\0"
LOWER = np.tril_indices(3)
Array = Any


def statement(seed: int, noise: float | None = None) -> tuple[dict[str, Any], Array]:
    """Arguments of a problem, and its whitening matrices, (n, 3, 3): |A (y - R x)|^2 is summed."""
    rng = np.random.default_rng(seed)
    kind, n = KINDS[seed % 3], int(rng.integers(6, 25))
    s = noise or 10 ** rng.uniform(-3, -0.7)
    x, turn = rng.normal(size=(n, 3)), Rotation.from_quat(rng.normal(size=4)).as_matrix()
    axes = rng.normal(size=(n, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    if kind == "covariances":
        roots = s * (np.eye(3) + 0.5 * rng.normal(size=(n, 3, 3)))
        given = {kind: roots @ roots.transpose(0, 2, 1)}
        errors = np.einsum("nij,nj->ni", roots, rng.normal(size=(n, 3)))
        whitening = np.linalg.inv(roots)
    else:
        given, errors = {kind: axes, "sigma": s}, s * rng.normal(size=(n, 3))
        along = axes[:, :, np.newaxis] * axes[:, np.newaxis]
        whitening = (along if kind == "normals" else np.eye(3) - along) / s
    return {"source": x, "target": x @ turn.T + errors, **given, "rotation_only": True}, whitening


def least(x: Array, y: Array, A: Array, starts: Array, *, moves: bool = False) -> tuple[float, Any]:
    """The least sum of |A (y - R x - t)|^2 of descents, t = 0 if it does not move; its R."""

    def residuals(at: Rotation, step: Array) -> Array:
        shift = step[3:] if moves else 0.0
        turned = (at * Rotation.from_rotvec(step[:3])).apply(x)
        return np.einsum("nij,nj->ni", A, y - turned - shift).ravel()

    best: tuple[float, Any] = (np.inf, None)
    for start in starts:
        at, step = Rotation.from_quat(start), np.zeros(6 if moves else 3)
        for _ in range(3):  # from where it ended, as near there the steps are exact
            found: Any = least_squares(partial(residuals, at), step, **TIGHT)
            at, step = at * Rotation.from_rotvec(found.x[:3]), np.r_[np.zeros(3), found.x[3:]]
        if 2 * found.cost < best[0]:
            best = 2 * float(found.cost), at
    return best


def optimum_missed(seed: int) -> str:
    """What is wrong with the certified optimum of an instance; empty where nothing is."""
    given, A = statement(seed)
    found = certreg.certify(certreg.RegistrationProblem(**given))
    starts = np.random.default_rng(seed).normal(size=(STARTS, 4))
    cost, _ = least(given["source"], given["target"], A, starts)
    objective = found.objective or 0.0
    if not found.unique or found.certificate is None:
        return f"{seed}: {found.status.value}"
    if abs(objective - cost) > AS_GOOD * cost:
        return f"{seed}: {objective!r} is certified, and SciPy finds {cost!r}"
    return accepted_alone(found.certificate.to_json(), seed)


def accepted_alone(text: bytes, seed: int) -> str:
    """What the checker, a program of its own, says against a certificate."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "certificate.json"
        path.write_bytes(text)
        command = [sys.executable, "-I", "-S", CHECKER, str(path)]
        run = subprocess.run(command, capture_output=True, text=True, check=False, encoding="utf-8")
    return "" if run.returncode == 0 else f"{seed}: {run.stdout}"


def variance_factor(seed: int) -> float:
    """The objective over the degrees of freedom, whose mean is 1 with as many as there are."""
    problem = certreg.RegistrationProblem(**statement(seed, NOISE)[0])
    found: Any = certreg.certify(problem)
    return found.covariance.variance_factor


def forged(seed: int) -> dict[str, Any]:
    """A certificate with another pose, with other data, or with the data of another motion."""
    rng = np.random.default_rng(seed)
    given, _ = statement(seed, NOISE)
    found: Any = certreg.certify(certreg.RegistrationProblem(**given))
    document = json.loads(found.certificate.to_json())
    way = seed // 3 % 4
    if way == 0:  # a pose beside the optimum
        q = np.array([float(k) for k in document["proof"]["pose"]])
        q += np.linalg.norm(q) * 10 ** rng.uniform(-4, 0) * rng.normal(size=4)
        document["proof"]["pose"] = [int(k) for k in q]
        return document
    if way == 1:  # that it is not unique
        document["claims"]["unique"] = False
        document["proof"]["symmetry"] = rng.integers(-3, 4, size=6).tolist()
        return document
    content = base64.b64decode(document["problem"]["data"])[len(PREFIXES[1]) :]
    prefix = PREFIXES[1]
    if way == 2:  # another point or spring
        numbers = np.frombuffer(content[8:]).copy()
        numbers[rng.integers(len(numbers))] += 10 ** rng.uniform(-3, 0)
        content = content[:8] + numbers.tobytes()
    else:  # with a translation
        prefix = PREFIXES[0]
        del document["rotation_only"]
    content = prefix + content
    digest, data = hashlib.sha256(content).hexdigest(), base64.b64encode(content).decode()
    document["problem"].update(data=data, digest=digest)
    return document


def is_false(document: dict[str, Any], seed: int) -> bool:
    """Whether SciPy shows that a claim of a certificate is wrong: its gap, or that it is a tie."""
    moves = "rotation_only" not in document
    content = base64.b64decode(document["problem"]["data"])[len(PREFIXES[not moves]) :]
    (n,) = struct.unpack("<Q", content[:8])
    x, y, factors = np.split(np.frombuffer(content[8:]).copy(), [3 * n, 6 * n])
    L = np.zeros((n, 3, 3))
    L[:, LOWER[0], LOWER[1]] = factors.reshape(n, 6)
    x, y, A = x.reshape(n, 3), y.reshape(n, 3), L.transpose(0, 2, 1)
    w, *axis = (float(k) for k in document["proof"]["pose"])
    there = np.einsum("nij,nj->ni", A, y - Rotation.from_quat([*axis, w]).apply(x))
    shift = np.zeros(3)
    if moves:
        wide, pulled = A.reshape(-1, 3), there.ravel()
        shift = np.linalg.lstsq(wide, pulled, rcond=None)[0]
        there = there - np.einsum("nij,j->ni", A, shift)
    energy = float((there**2).sum())
    starts = np.concatenate([[[*axis, w]], np.random.default_rng(seed).normal(size=(4, 4))])
    cost, _ = least(x, y, A, starts, moves=moves)
    mantissa, exponent = document["claims"]["gap"]
    too_small = energy - cost > mantissa * 2.0**exponent + FALSE * energy
    return too_small or document["claims"]["unique"] is False  # planes of random normals: unique


def main(instances: int = INSTANCES, noises: int = NOISES, forgeries: int = FORGERIES) -> int:
    """All three; 1 where anything is wrong."""
    wrong = [words for words in map(optimum_missed, range(instances)) if words]
    sys.stdout.write(f"{instances} instances: optimum missed or not proved {len(wrong)} {wrong}\n")
    factors = np.array([variance_factor(seed) for seed in range(noises)])
    mean, error = float(factors.mean()), float(factors.std(ddof=1) / np.sqrt(noises))
    sys.stdout.write(f"{noises} variance factors: mean {mean:.4f} +- {error:.4f}\n")
    made = [(seed, forged(seed)) for seed in range(forgeries)]
    false = [document for seed, document in made if is_false(document, seed)]
    passed = [document for document in false if check(json.dumps(document).encode()).verified]
    sys.stdout.write(f"{forgeries} forgeries: {len(false)} false, accepted {len(passed)}\n")
    return 1 if wrong or passed or abs(mean - 1) > 3 * error else 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
