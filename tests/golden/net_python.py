"""Results of Python calls in words, documents, cards and pages; the steps `python` of the net.

What the command line reaches is not here: results in which something is missing or in doubt, and
those that only Python gives.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import net_inputs
import numpy as np
from bad_files import BAD
from commands import certreg, checked
from corpus import ROOT, bad_arguments, slug

import certreg as package
from certreg import Registration, SimulationSettings, Verdict, assess, certify, simulate

if TYPE_CHECKING:
    from collections.abc import Callable

    from certreg import RegistrationProblem

CODES = {"ContradictionError": 1, "RefusedCertificateError": 1, "UndecidedError": 4}  # else 2
SPEAKS = re.compile(
    r'class="(?:stamp|lead|warning)|<p class="note"|<h1>|<li>|<dt>|"(?:ended|still)"'
)
EVERYWHERE = ("<li>that the ", "<li>where the points", "Each pair is joined", "Exact: integer")


def problem(source: str, target: str, **more: Any) -> RegistrationProblem:
    clouds = net_inputs.clouds()
    return package.RegistrationProblem(clouds[source], clouds[target], **more)


@cache
def lost() -> Any:
    """What stands in the place of a value that is missing: of the class that results take."""
    missing = assess(bare(), bare().pose).absent["slip"]
    return replace(missing, reason="lost")


@cache
def bare(source: str = "axes", target: str = "turned") -> Registration:
    """A proof alone."""
    return certify(problem(source, target, damping=2.0), relaxation=False, simulation=False)


@cache
def whole() -> Registration:
    stated = problem("cloud", "noisy", damping=2.0)
    return certify(stated, about={"labels": net_inputs.LABELS})


def page(registration: Registration) -> str:
    from net import page as readable

    return readable(registration.report("page.html").read_text("utf-8"))


def sentences_of(text: str) -> str:
    """The lines of a page that speak, without its data."""
    lines = (line for line in text.split("\n") if SPEAKS.search(line))
    kept = (line for line in lines if not any(words in line for words in EVERYWHERE))
    return "\n".join(line.partition('<p class="rests-on">')[0] for line in kept)


def refused(call: Callable[[], Any]) -> str:
    """What a call gives in short, or its error."""
    try:
        return repr(call())
    except Exception as error:  # noqa: BLE001 (whatever it is, it is part of the record)
        kinds = [kind.__name__ for kind in type(error).__mro__]
        code = next((CODES[kind] for kind in kinds if kind in CODES), 2)
        return f"{kinds[0]} (code {code}): {error}"


def told(**texts: str) -> str:
    return "\n".join(f"--- {name}\n{text}" for name, text in texts.items())


def cards() -> str:
    """Every result as a notebook shows it."""
    from net import page as readable

    stated = problem("axes", "turned", damping=2.0)
    shown: dict[str, Any] = {
        "registration": whole(),
        "one": bare("one", "other"),
        "poor": bare("cloud", "outlier"),
        "huge": bare("huge", "huge"),
        "near": assess(bare(), np.eye(3), [0.0, 0.0, 0.0]),
        "optimal": assess(bare(), bare().pose),
        "reflected": assess(bare(), np.diag([1.0, 1.0, -1.0]), [0.0, 0.0, 0.0]),
        "listed": package.equilibria(stated),
        "set": bare().equilibria,
        "run": simulate(stated),
        "still": simulate(problem("flat", "flat")),
        "huger": bare("axes", "huger"),
        "verdict": package.verify(checked(bare().certificate)),
        "refused": package.verify(b"{}"),
    }
    texts = {name: f"{one!r}\n{readable(one._repr_html_())}" for name, one in shown.items()}
    return told(**texts)


def texts() -> str:
    """What `str` and `to_dict` say of results that the command line shows otherwise."""
    stated = problem("axes", "turned", damping=2.0)
    found = bare().equilibria
    trajectory: Any = simulate(stated, "splitting")
    return told(
        set=f"{found}\n{json.dumps(sorted(found.to_dict()))}",
        listed=str(package.equilibria(stated, "all")),
        run=f"{trajectory}\n{json.dumps(trajectory.to_dict(), indent=1)}",
        pose=f"{bare().pose!r} {bare().pose.inverse().T_target_source.tolist()}",
        covariance=f"{checked(checked(whole().covariance).ros).tolist()}"
        f"\n{checked(checked(whole().covariance).gtsam).tolist()}",
        residuals=f"{whole().residuals.tolist()}",
        register=f"{package.register(stated.source, stated.target)!r}",
        damped=f"{certify(problem('axes', 'turned')).to_dict()['damping']}",
    )


def uncertified(registration: Registration) -> Registration:
    """The same without certificate, verdict and bounds."""
    return replace(
        registration,
        verdict=None,
        bounds=None,
        solution=replace(registration.solution, certificate=None, absent={"certificate": lost()}),
        absent={"bounds": lost()},
    )


def missing() -> str:
    """Registrations that lack what others have: nothing is claimed, and it is said why."""
    proof = whole()
    bounds, limits = checked(proof.bounds), type(proof.limits)
    rulings = type(checked(proof.verdict).ruling)
    far = replace(bounds, greatest_gap=Fraction(10) ** 400)
    shown = {
        "unverified": replace(proof, verdict=None),
        "refuted": replace(proof, verdict=Verdict(ruling=rulings.REFUTED, words="no")),
        "unbounded": replace(proof, bounds=None, absent={"bounds": lost()}),
        "without angle": replace(
            proof, bounds=replace(bounds, angle_upper=None, absent={"angle_upper": lost()})
        ),
        "vacuous": replace(proof, bounds=replace(far, angle_upper=math.pi)),
        "nothing": replace(proof, bounds=replace(bounds, least_range_squared=Fraction(1, 10**40))),
        "limited": replace(proof, limits=limits(max_gap=0.5, max_angle=0.25)),
        "without a pose": replace(
            proof, objective=None, rmse=None, absent={"objective": lost(), "rmse": lost()}
        ),
    }
    lines = [
        f"--- {name}\n{one!r}\n{_begun(one)}\n{_optimality(one)}" for name, one in shown.items()
    ]
    unproved = uncertified(proof)
    lines += [
        _begun(unproved),
        _optimality(unproved),
        str(unproved.save("bare")),
        " ".join(sorted(path.name for path in Path("bare").iterdir())),
        refused(lambda: unproved.report("page.html")),
        refused(lambda: assess(unproved, unproved.pose)),
        refused(lambda: assess(unproved, np.diag([1.0, 1.0, -1.0]), [0.0, 0.0, 0.0])),
        unproved._repr_html_(),
    ]
    return "\n".join(lines)


def _begun(registration: Registration) -> str:
    """The summary up to the pose, and what the methods say."""
    head, _, rest = str(registration).partition("\n\n")
    lines = rest.partition("\n\n")[0].split("\n")
    kept = (line for line in lines if line.startswith(("  relax", "  simul", "  RMSE", "    ")))
    return "\n".join((head, *kept))


def _optimality(registration: Registration) -> str:
    document = registration.to_dict()
    kept = {"optimality": document["optimality"], "reasons": document["reasons"]}
    return json.dumps(kept | {"certificate": document["certificate"]})


def weaken(certificate: str, weaker: str, pattern: str = "kept") -> str:
    """A certificate that claims less than it could, which is true all the same."""
    document = json.loads(Path(certificate).read_bytes())
    claims = document["claims"]
    claims["gap"][1] += 190
    claims["sin2_half_angle"][1] += 190
    if pattern == "none":
        claims |= {"sin2_half_angle": None, "basin": None, "unstable": None}
    text = json.dumps(document, indent=1, sort_keys=True)
    Path(weaker).write_text(f"{text}\n", "utf-8")
    return f"{weaker} written"


def renamed(certificate: str, other: str) -> str:
    """The same certificate with another `about`, which is not proved."""
    document = json.loads(Path(certificate).read_bytes())
    document["about"] = {"damping": "much", "labels": [1], "source": 3}
    Path(other).write_text(json.dumps(document, indent=1, sort_keys=True) + "\n", "utf-8")
    return f"{other} written"


def bared(certificate: str, other: str) -> str:
    """The same certificate without the points, which it is about by their digest."""
    document = json.loads(Path(certificate).read_bytes())
    document["problem"]["data"] = None
    Path(other).write_text(json.dumps(document, indent=1, sort_keys=True) + "\n", "utf-8")
    return f"{other} written"


def poses() -> str:
    """What is said of poses in the forms that Python takes."""
    stated = problem("cloud", "noisy", sigma=0.02)
    proof = certify(stated, relaxation=False, simulation=False)
    best, line = proof.pose, bare("22-source", "22-target")
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    given: dict[str, Any] = {
        "itself": (proof, best),
        "rotation alone": (proof, best.rotation),
        "quaternion alone": (proof, best.quaternion_wxyz),
        "wrong rotation alone": (proof, turn.T),
        "reordered alone": (proof, np.roll(best.quaternion_wxyz, -1)),
        "far off": (proof, best.rotation, best.translation + 1e170),
        "scaled quaternion": (proof, 0.5 * best.quaternion_wxyz, best.translation),
        "zero": (proof, np.zeros((3, 3)), best.translation),
        "scaled alone": (proof, 3.0 * turn),
        "line": (line, line.pose),
        "line near": (line, np.eye(3)),
        "flat": (bare("axes", "shifted"), np.eye(3), [4.0, 6.0, 15.5]),
        "flat far": (bare("axes", "shifted"), np.eye(3), [400.0, 6.0, 15.5]),
        "narrow": (bare("axes", "narrow"), np.eye(4)),
        "scale": (bare("cloud", "scaled"), bare("cloud", "scaled").pose),
        "twice": (bare("cloud", "twice"), bare("cloud", "twice").pose),
        "shuffled": (bare("cloud", "rolled"), bare("cloud", "rolled").pose),
        "twice near": (bare("cloud", "twice"), turn, bare("cloud", "twice").pose.translation),
        "scale near": (bare("cloud", "scaled"), turn, bare("cloud", "scaled").pose.translation),
        "far": (bare("cloud", "farther"), bare("cloud", "farther").pose),
        "huge": (bare("huge", "huge"), np.eye(4)),
    }
    slip = checked(assess(proof, best.inverse()).slip)
    texts = [f"--- {n}\n{assess(*one)}" for n, one in given.items()]
    texts += [
        refused(lambda: assess(stated.source, best)),  # pyright: ignore[reportArgumentType]
        refused(lambda: assess(stated, np.eye(2), [0, 0, 0])),
        " ".join(code.value for code in type(slip.code)),
    ]
    return "\n".join(texts)


def calls() -> str:
    """Calls that are refused, each in a line, and some that are not."""
    clouds = net_inputs.clouds()
    stated = problem("axes", "turned")
    anything: Any = stated
    some: list[Callable[[], Any]] = [
        lambda: certify(stated, clouds["turned"]),
        lambda: certify(stated, sigma=1.0),
        lambda: certify(stated, clouds["turned"], sigma=1.0, damping=2.0),
        lambda: certify(clouds["axes"]),
        lambda: certify(clouds["axes"], clouds["turned"], sigma=2.0, simulation="euler"),
        lambda: certify(stated, max_gap=2.0),
        lambda: certify(stated, simulation="rk4"),
        lambda: package.equilibria(stated, "guess"),
        lambda: simulate(stated, step=-1.0),
        lambda: package.certify_many([(clouds["axes"], clouds["half"]), stated], simulation=False),
        lambda: package.certify_many([stated, ([[1]], [[2]])], errors="keep"),
        lambda: package.certify_many([stated, ([[1]], [[2]])]),
        lambda: package.certify_many([], errors=anything),
        lambda: package.register(clouds["line"], clouds["bent"]),
        lambda: package.register(clouds["axes"], clouds["mirrored"]),
        lambda: package.verify("nowhere.json"),
        lambda: bool(package.verify(b"")),
        lambda: certify(clouds["axes"], clouds["huge"] * 1e130),
        lambda: bare().plot(object()),
    ]
    return "\n".join(refused(call) for call in some)


def bad_files() -> str:
    """What is said of each bad file, in a line."""
    lines = list[str]()
    for name, bad in BAD.items():
        place = Path(slug(name))
        place.mkdir()
        for side in ("source", "target"):
            (place / f"{side}.csv").write_text("0,0,0\n1,0,0\n0,2,0\n0,0,3\n", "utf-8")
        for file, content in bad.files.items():
            (place / file).write_bytes(content)
        run = certreg("certify", *bad_arguments(bad, str(place)), "--no-simulation")
        lines.append(f"{name}: {run.code} {run.err.strip()}")
    return "\n".join(lines)


def formats() -> str:
    """What is read of files that other programs wrote."""
    lines = list[str]()
    for path in sorted((ROOT / "tests" / "io" / "data").iterdir()):
        if path.suffix in {".md", ".e57"}:
            continue
        read = package.load(path)
        points = np.asarray(read.points, float)
        labels = None if read.labels is None else read.labels[:2]
        lines.append(f"{path.name}: {points.shape} {points.sum(axis=0).tolist()} {labels}")
    return "\n".join(lines)


def runs() -> str:
    """Simulations that end otherwise than near the one optimum."""
    lines = list[str]()
    for source, target, settings in (
        ("cloud", "tilted", SimulationSettings(step=0.01, max_steps=40)),
        ("13-source", "13-target", SimulationSettings()),
        ("flat", "flat", SimulationSettings()),
        ("axes", "half", SimulationSettings(max_steps=3)),
    ):
        trajectory: Any = simulate(problem(source, target), settings=settings)
        lines += [str(trajectory), *trajectory.notes]
    return "\n".join(lines)
