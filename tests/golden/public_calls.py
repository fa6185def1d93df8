"""Calls of certreg's public names, whose results are printed as JSON; for the golden record.

Only what the guides teach: names of `certreg`, and the fields of their results that are documented.
"""

from __future__ import annotations

import enum
import inspect
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from corpus import ROWS, random_pair

import certreg

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

CALLED = (
    "RegistrationProblem",
    "assess",
    "certify",
    "equilibria",
    "register",
    "simulate",
    "verify",
)
NAMES = (
    *("Assessment", "Certificate", "CertregError", "Pose", "Registration", "Trajectory"),
    *("Verdict", "__version__", *CALLED),
)
POINTS = [[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]


def names() -> None:
    """Every public name, and how the functions are called."""
    for name in NAMES:
        value = getattr(certreg, name)
        called = _parameters(value) if name in CALLED else None
        tell(name, [name in certreg.__all__, name in dir(certreg), called])


def problems() -> None:
    """What a problem knows of itself."""
    for name, (source, target) in pairs():
        problem = certreg.RegistrationProblem(source, target, sigma=0.25)
        tell(name, [problem.n, problem.digest(), problem.source, problem.target, problem.damping])


def errors() -> None:
    """Refusals in words, and what kind of error they are."""
    array = np.array(POINTS)
    nan = np.where(array == 2, np.nan, array)
    clouds: tuple[Any, ...] = (
        *([], POINTS[:3], array.T, array[:, :2], [1.0, 2, 3], array[None], [[1, 2], [3]], None),
        *(nan, array + 0j, array > 0, array.astype(object), [["1", "2", "3"]]),
        *(np.ma.masked_equal(array, 3), array.astype(int) + 2**53 + 1),
    )
    for k, cloud in enumerate(clouds):
        refused(f"source {k}", lambda cloud=cloud: certreg.RegistrationProblem(cloud, POINTS))
        refused(f"target {k}", lambda cloud=cloud: certreg.RegistrationProblem(POINTS, cloud))
        refused(f"register {k}", lambda cloud=cloud: certreg.register(cloud, POINTS))
    options: tuple[dict[str, Any], ...] = (
        *({"sigma": 1, "weights": [1] * 4}, {"sigma": 0}, {"sigma": [1, 1, -2, 1]}),
        *({"sigma": np.nan}, {"sigma": "abc"}, {"weights": [0] * 4}, {"weights": [1, -1, 1, 1]}),
        *({"weights": [1] * 5}, {"damping": 0}, {"damping": None}, {"damping": np.inf}),
    )
    for k, option in enumerate(options):
        refused(f"option {k}", lambda o=option: certreg.RegistrationProblem(POINTS, POINTS, **o))
    problem = certreg.RegistrationProblem(POINTS, POINTS)
    refused("method", lambda: certreg.equilibria(problem, method="guess"))
    refused("integrator", lambda: certreg.simulate(problem, integrator="rk4"))
    refused("step", lambda: certreg.simulate(problem, step=0.0))
    refused("pose", lambda: certreg.assess(problem, np.eye(2), [0, 0, 0]))
    refused("line", lambda: certreg.register(ROWS["22"][0], ROWS["22"][1]))
    refused("certificate", lambda: certreg.verify("nowhere.json"))
    refused("verdict", lambda: bool(certreg.verify(b"")))


def register() -> None:
    """The pose in floating point."""
    for name, (source, target) in pairs():
        refused(name, lambda s=source, t=target: pose(certreg.register(s, t)))


def equilibria() -> None:
    """The equilibrium set by every method."""
    for name, (source, target) in pairs():
        problem = certreg.RegistrationProblem(source, target)
        for method in ("spectral", "groebner", "homotopy", "all"):
            refused(f"{name} {method}", lambda p=problem, m=method: _set(certreg.equilibria(p, m)))


def simulate() -> None:
    """A motion by every integrator."""
    for name, (source, target) in pairs():
        problem = certreg.RegistrationProblem(source, target)
        for integrator in ("euler", "midpoint", "splitting"):
            refused(
                f"{name} {integrator}",
                lambda p=problem, i=integrator: _motion(certreg.simulate(p, i, step=0.05)),
            )


def certify() -> None:
    """Registrations, their certificates, and what is said of another pose."""
    for name, (source, target) in pairs():
        problem = certreg.RegistrationProblem(source, target, damping=2.0)
        result = certreg.certify(problem, about={"by": "hand"})
        tell(name, [result.status, result.objective, result.rmse, pose(result.pose)])
        tell(name, _set(result.equilibria))
        if result.certificate is not None:
            result.certificate.save("certificate.json")
            verdict = certreg.verify("certificate.json", problem)
            told = [verdict.ruling, verdict.proved, verdict.words, verdict.theorems, repr(verdict)]
            tell(name, told)
            tell(name, Path("certificate.json").read_text("utf-8"))
        found = certreg.assess(problem, np.eye(3), result.pose.translation)
        fields = ("verdict", "words", "objective", "rmse", "gap_lower", "gap_upper", "hint")
        more = ("angle_to_optimum", "nearest_index", "nearest_angle")
        tell(name, {field: getattr(found, field) for field in fields + more})


def verdicts(*files: str) -> None:
    """The checker's answer on each of the files."""
    for file in files:
        verdict = certreg.verify(file)
        tell(Path(file).name, [verdict.ruling, verdict.words, verdict.theorems])


def pairs() -> Iterator[tuple[str, tuple[Any, Any]]]:
    """The rows of the classification, and some random problems."""
    yield from ROWS.items()
    yield from ((str(number), random_pair(number)) for number in range(300, 312))


def tell(name: str, value: Any) -> None:
    """A line of JSON."""
    sys.stdout.write(f"{name}: {json.dumps(plain(value))}\n")


def refused(name: str, call: Callable[[], Any]) -> None:
    """What the call gives, or the error it raises."""
    try:
        tell(name, call())
    except Exception as error:  # noqa: BLE001 (whatever it is, it is part of the record)
        kinds = [kind.__name__ for kind in type(error).__mro__[:-2]]
        tell(name, [*kinds, isinstance(error, certreg.CertregError), str(error)])


def pose(value: Any) -> Any:
    """The fields of a pose."""
    return [value.rotation, value.translation, value.quaternion_wxyz, value.T_target_source]


def plain(value: Any) -> Any:
    """A value as JSON has it; of what JSON does not have, the name of its type."""
    if isinstance(value, np.ndarray | np.generic):
        if np.iscomplexobj(value):
            return [value.real.tolist(), value.imag.tolist()]
        return plain(value.tolist())
    if isinstance(value, enum.Enum):
        return value.value
    if isinstance(value, dict):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return value if isinstance(value, str | float | int | None) else type(value).__name__


def _parameters(value: Any) -> Any:
    return [
        str(p.replace(annotation=p.empty)) for p in inspect.signature(value).parameters.values()
    ]


def _set(found: Any) -> Any:
    fields = (
        *("kind", "basis", "morse_index", "unstable_eigenvalues", "eigenvalues", "witness"),
        *("energy", "rmse", "rotation", "quaternion_wxyz", "angle_to_optimum", "optimal"),
    )
    components = [[getattr(each, field) for field in fields] for each in found.components]
    margin = [found.margin.eigenvalue_gap, found.margin.relative]
    return [components, margin, found.guarantee, found.complete]


def _motion(found: Any) -> Any:
    end = getattr(found, "trajectory", found)
    fields = (
        *("integrator", "status", "step", "steps", "escapes", "quaternion", "angular_velocity"),
        *("speed", "predicted_rate", "decay_rate", "notes", "converged", "length_exponent"),
    )
    told = {field: getattr(end, field) for field in fields}
    sums = [float(np.sum(np.abs(getattr(end, a)))) for a in ("times", "states", "potential")]
    return [told, end.states.shape, sums]
