"""What is shown of the problems of `net_worlds.py`: words, figures, cards, pages; in short records.

A line that was there before but for its numbers is its place, as @12, and the numbers. So a page
costs a line or two for each sentence, and still nothing of it can change unseen.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from answers import answered
from commands import checked
from net_inputs import clouds, rounded
from net_inside import spoken_of_warnings
from net_python import poses as poses_in_python
from net_python import refused, uncertified
from net_worlds import ALONE, World, moved, poses, worlds

from certreg import Registration, RegistrationProblem, assess, certify, equilibria, register

if TYPE_CHECKING:
    from collections.abc import Iterator

NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?!\w)")
SOLVER = re.compile(r"SDP|semidefinite|sdp_gap|rotation alone|Independent")  # compared as they are
MANY = 16  # numbers of a line; of more the sums
DIGEST = re.compile(r"\b[0-9a-f]{64}\b")
LEFT_OUT = ('   "quaternion"', '   "quaternions"')  # the basis of a point; of a motion: up to sign
KEPT = ("optimality", "fit", "margin")
CODES = {"certified": 0, "certified-not-unique": 3, "bounded": 4, "not-certified": 4}


class Short:
    """Lines, each of them once."""

    def __init__(self, known: str = "") -> None:
        self._known = dict[str, int]()
        list(self.lines(known))

    def lines(self, text: str) -> Iterator[str]:
        """A text, of what was there already the numbers; places that follow one another as one."""
        first, last = 0, -1
        for place, line in self._placed(text):
            if place is not None and place == last + 1 and first <= last:
                last = place
                continue
            if first <= last:
                yield f"@{first}" if first == last else f"@{first}-@{last}"
            first, last = (0, -1) if place is None else (place, place)
            if place is None:
                yield line
        if first <= last:
            yield f"@{first}" if first == last else f"@{first}-@{last}"

    def _placed(self, text: str) -> Iterator[tuple[int | None, str]]:
        """Lines, each with its place where it is known and has no number."""
        for line in DIGEST.sub("DIGEST", text).split("\n"):
            numbers, frame = NUMBER.findall(line), " ".join(NUMBER.sub("#", line).split())
            if not re.search(r"\w", frame) or line.startswith(LEFT_OUT):
                continue
            told = " ".join(map(_kept, numbers)) if len(numbers) <= MANY else _sums(numbers)
            if SOLVER.search(line):
                yield None, line
            elif frame not in self._known:
                self._known[frame] = len(self._known)
                yield None, line if len(numbers) <= MANY else f"{_cut(frame)} {told}"
            else:
                place = self._known[frame]
                yield None if numbers else place, f"@{place} {told}"


def _cut(frame: str) -> str:
    """The beginning of a long line, and a digest of it all."""
    return f"{frame[:40]} {hashlib.sha256(frame.encode()).hexdigest()[:8]}"


def _kept(number: str) -> str:
    """As it was told, if it is not told with all its digits."""
    return number if len(number) <= len("0.1234567") else f"{float(number):.7g}"


def _sums(numbers: list[str]) -> str:
    """Of many numbers how many they are, and two sums: another order has another."""
    values = [float(number) for number in numbers]
    places = (k * value for k, value in enumerate(values, 1))
    return f"{len(values)}: {math.fsum(values):.7g} {math.fsum(places):.7g}"


def shown(group: str, *pages: str) -> str:
    """All of a group; with the pages of those named."""
    short, lines = Short("" if group == "patterns" else _usual()), list[str]()
    for name, world in worlds(group).items():
        registration = _certified(world)
        told = str(registration)
        if not name.startswith("times"):
            told += _figures(registration)
        if name in pages:
            told += _page(registration)
        lines += [f"--- {name}", *short.lines(_once(told, registration))]
    return "\n".join(lines)


def _certified(world: World) -> Registration:
    about = {"labels": world.labels} if world.labels else None
    return certify(world.problem, about=about, **world.certified)


@cache
def _usual() -> str:
    """What the first of the patterns shows, where it is in full."""
    registration = _certified(worlds("patterns")["plain"])
    return "".join((str(registration), _figures(registration), _page(registration)))


def _once(text: str, registration: Registration) -> str:
    """A text in which each warning of the fit is told but once, and then named."""
    for one in registration.fit.warnings:
        for words in (one.text, one.remedy):
            begun, found, rest = text.partition(words)
            text = f"{begun}{found}{rest.replace(words, f'[{one.code.value}]')}"
    return text


def _figures(registration: Registration) -> str:
    """The figures and the card; and of the optimum itself what is judged."""
    document = registration.to_dict()
    figures = {key: document[key] for key in KEPT}
    figures["uncertainty"] = document["pose"]["uncertainty"]
    reasons = [f"{why} ({key})" for key, why in document["reasons"].items() if "pose" in key]
    judged = assess(registration, registration.pose)
    return "\n".join(
        (
            f"\ncode {CODES[registration.status.value]} {registration!r}",
            *(f"{key}: {json.dumps(_rounded(value))}" for key, value in figures.items()),
            *reasons,
            _readable(registration._repr_html_()),
            str(judged),
        )
    )


def _page(registration: Registration) -> str:
    return "\n" + _readable(registration.report("page.html").read_text("utf-8"))


def _readable(text: str) -> str:
    from net import STYLE, page  # it reads this module

    return STYLE.sub("", page(text))


def _rounded(value: Any) -> Any:
    """Numbers in seven digits."""
    if isinstance(value, float):
        return float(f"{value:.7g}")
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    if isinstance(value, dict):
        return {key: _rounded(each) for key, each in value.items()}
    return value


def judged(offset: str, sigma: str, *names: str) -> str:
    """Poses of other tools, of clouds so far from the origin; with noise so large, or exact."""
    short, lines, noise = Short(), list[str](), float(sigma)
    cloud = 5.0 * rounded(clouds()["cloud"] / 5.0) + float(offset)  # so the turn of it is exact
    stated = RegistrationProblem(cloud, moved(cloud, noise), sigma=noise or None)
    registration = certify(stated, **ALONE)
    own = (registration.pose.rotation.round(6), registration.pose.translation.round(6))
    for name, (turn, shift) in {**poses(), "six decimals": own}.items():
        if names and name not in names:
            continue
        one = assess(registration, turn, shift)
        told = str(one).partition("  the optimum: wxyz")[0]
        card = "" if noise else _readable(one._repr_html_())
        lines += [f"--- {name}", *short.lines(f"{told}\n{card}")]
    return "\n".join(lines)


def listed(group: str) -> str:
    """All equilibria by the method that proves least, where it leaves something in doubt."""
    short, lines = Short(), list[str]()
    for name, world in worlds(group).items():
        listed: Any = equilibria(world.problem, "homotopy")
        found = listed.enumeration.equilibria
        told = f"{found}\n{_readable(found._repr_html_())}"
        lines += [f"--- {name}", *short.lines(told)]
    return "\n".join(lines)


def spurious() -> str:
    """Poses at every equilibrium of every kind, with the best shift and with another."""
    short, lines = Short(), list[str]()
    for name, world in worlds("patterns").items():
        registration = certify(world.problem, **ALONE)
        shift = registration.pose.translation + np.array([0.0, 0.0, 0.25])
        for component in registration.equilibria.components:
            turn = component.rotation
            beside = registration.pose.translation + np.array([0.0, 0.0, 0.002])
            each = (assess(registration, turn, given) for given in (None, shift, beside))
            told = "\n".join(str(one).partition("\n\n")[0] for one in each)
            lines += [f"--- {name} {component.morse_index}", *short.lines(told)]
    return "\n".join(lines)


def altered() -> str:
    """What is said of limits that were moved, of a body kicked twice, and of where it then ends."""
    short, lines = Short(), list[str]()
    for name in ("plain", "22", "4", "4-one-point"):
        found = _certified(worlds("patterns")[name])
        bounds = checked(found.bounds)
        unit = Fraction(math.sqrt(bounds.least_range_squared)) or bounds.flat_energy
        for share in (Fraction(1, 2), Fraction(7, 2)):
            wide = replace(bounds, greatest_gap=share * unit)
            limits_of = type(found.limits)
            for limits in (limits_of(), limits_of(max_gap=0.99, max_angle=3.0)):
                one = replace(found, bounds=wide, limits=limits)
                told = str(one).partition("\n\n")[0]
                lines += [f"--- {name} {share} {limits.max_gap}", *short.lines(told)]
    plain = _certified(worlds("patterns")["half a turn"])
    run: Any = plain.solution.trajectory
    statuses: Any = type(run.status)
    for escapes in (0, 1, 2):
        for status in statuses:
            ended = answered(plain, trajectory=replace(run, escapes=escapes, status=status))
            spoken = (line for line in _page(ended).split("\n") if '"ended"' in line)
            told = "\n".join((str(ended), *spoken))
            lines += [f"--- {escapes} {status.name}", *short.lines(told)]
    return "\n".join(lines)


def unsaid() -> str:
    """What no pair of clouds brings up: wrong arguments, and a fit that explains much."""
    plain = _certified(worlds("patterns")["plain"])
    axes, problem = clouds()["axes"], plain.problem
    pose: Any = problem
    unproved = uncertified(plain)
    mirror = np.diag([1.0, 1.0, -1.0])
    calls = (
        lambda: register(axes, axes[:4]),
        lambda: register(axes, axes, [1.0, 2.0]),
        lambda: assess(problem, pose),
        lambda: assess(pose.source, problem),
        lambda: assess(unproved, mirror, [0.0, 0.0, 0.0]).unexplained,
    )
    few = (_certified(worlds("noise")[name]).fit.stated("scale_p") for name in ("one", "two"))
    told = spoken_of_warnings(plain.fit)
    return "\n".join((*(refused(call) for call in calls), *map(str, few), *told))


def posed() -> str:
    """What is said of poses in the forms that Python takes."""
    return "\n".join(Short().lines(poses_in_python()))


STEPS = {
    "poses": posed,
    "unsaid": unsaid,
    "shown": shown,
    "judged": judged,
    "listed": listed,
    "spurious": spurious,
    "altered": altered,
}
