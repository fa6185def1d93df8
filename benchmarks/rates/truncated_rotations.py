"""Truncated squares over rotations: how many random problems are proved, and in what time.

    make rates NAME=truncated_rotations ARGS="[INSTANCES]"

Directions with noise of 0.01 and bounds of 5.54 times that, up to 60 % of the pairs wrong; then
harder families. Few pairs are searched exhaustively, too; forgeries are offered to the checker. Run
by `make rates NAME=truncated_rotations`; a part of it is in the tests.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import dataclass
from importlib import import_module
from itertools import product
from typing import Any

import numpy as np
from rotated_pairs import RotatedPairs, rotated_pairs

from certreg.certificate.truncated import truncated_certificate
from certreg.problem.bounds import bounded
from certreg.problem.problem import RegistrationProblem
from certreg.problem.support import Loss
from certreg.relaxation.rotation_boxes import BoundedPairs, search_boxes

checker = import_module("certreg.verify")
INSTANCES = 100
SIZES, SHARES = (10, 12, 20, 50, 100), (0.0, 0.2, 0.4, 0.6)
EXHAUSTED = 12  # pairs: 4095 sets
FORGED = 20  # pairs of problems whose certificates are forged
SECONDS = 10.0  # of processor time, of search and check together


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial:
    """One problem: whether labels, angle and uniqueness are proved, and the seconds that took.

    excess: of the cost over that of an exhaustive search; None where none was made.
    forgeries: how many there were of the certificate, and how many of them were accepted.
    """

    name: str
    proved: bool
    boxes: int
    search: float
    check: float
    excess: float | None
    forgeries: tuple[int, int]


def trial(name: str, given: RotatedPairs, *, forge: bool = False) -> Trial:
    """Of one problem."""
    points = RegistrationProblem(given.source, given.target, rotation_only=True)
    problem = bounded(points, given.bounds, Loss.TRUNCATED)
    start = time.process_time()
    found = search_boxes(problem.source, problem.target, problem.bounds)
    middle = time.process_time()
    made, verdict = truncated_certificate(problem, found.quaternion, found.labels, found.gap)
    end = time.process_time()
    document = json.loads(made.to_json()) if made else {}
    return Trial(
        name=name,
        proved=verdict.proved and made is not None and made.body.claims.unique,
        boxes=found.boxes,
        search=middle - start,
        check=end - middle,
        excess=found.cost - least_cost(problem) if problem.n <= EXHAUSTED else None,
        forgeries=forged(document) if forge and made else (0, 0),
    )


def least_cost(problem: RegistrationProblem) -> float:
    """The least cost over the fits of all sets of pairs: an optimum is the fit of its labels."""
    pairs = BoundedPairs.of(problem.source, problem.target, problem.bounds)
    sets = np.array(list(product((0.0, 1.0), repeat=problem.n)))[1:]
    lines = pairs.lines.reshape(-1, 4, 4)
    matrices = np.einsum("kn,nij,nil->kjl", sets, lines, lines)
    fits = np.linalg.eigh(matrices)[1][:, :, 0]
    return float(np.minimum(pairs.squares(fits), 1.0).sum(axis=1).min())


def forged(document: dict[str, Any]) -> tuple[int, int]:
    """Claims that are false: each label turned round, a rotation that is a little off."""
    claims, pose = document["claims"], document["pose"]
    labels = claims["labels"]
    other = {"1": "0", "0": "1", "?": "1"}
    false = [
        document | {"claims": claims | {"labels": labels[:k] + other[labels[k]] + labels[k + 1 :]}}
        for k in range(len(labels))
    ]
    size = max(map(abs, pose))
    false += [
        document | {"pose": [entry + (k == at) * size // 1000 for k, entry in enumerate(pose)]}
        for at in range(4)
    ]
    accepted = sum(checker.check(json.dumps(each).encode()).verified for each in false)
    return len(false), accepted


def usual(instances: int) -> list[Trial]:
    """Random problems of all sizes and shares in turn."""
    cells, rng = list(product(SIZES, SHARES)), np.random.default_rng(20)
    trials: list[Trial] = []
    for k in range(instances):
        n, share = cells[k % len(cells)]
        name = f"{n:4d} pairs, {share:4.0%} wrong"
        forge = k < len(cells) and n <= FORGED
        trials.append(trial(name, rotated_pairs(rng, n, share), forge=forge))
    return trials


def hard(instances: int) -> list[Trial]:
    """Nine tenths wrong; bounds of a quarter of the points; two rotations; too narrow bounds.

    Of 49 pairs, two thirds of them wrong, noise of three bounds, and bounds and noise so wide that
    many pairs are near to theirs: of what was tried these take the most boxes, and the most seconds
    of the checker.
    """
    rng, trials = np.random.default_rng(21), list[Trial]()
    noisy = np.random.default_rng(22)
    for k in range(instances):
        n = (20, 50, 100)[k % 3]
        one, other = rotated_pairs(rng, n, 0.0), rotated_pairs(rng, n, 0.0)
        first, bounds = np.arange(n) < n // 2, one.bounds
        source = np.where(first[:, np.newaxis], one.source, other.source)
        target = np.where(first[:, np.newaxis], one.target, other.target)
        families = {
            "nine of ten wrong": rotated_pairs(rng, n, 0.9),
            "wide bounds": _with_bounds(rotated_pairs(rng, n, 0.5), 5.0 * bounds),
            "two rotations": RotatedPairs(source=source, target=target, bounds=bounds, true=first),
            "narrow bounds": _with_bounds(one, 0.25 * bounds),
        }
        for name, sigma, bound in (("noise of 3 bounds", 0.1, 0.035), ("wide noise", 0.5, 0.6)):
            given = rotated_pairs(noisy, 49, 0.65, sigma)
            families[name] = _with_bounds(given, np.full(49, bound))
        trials += [trial(name, given) for name, given in families.items()]
    return trials


def _with_bounds(given: RotatedPairs, bounds: np.ndarray) -> RotatedPairs:
    return RotatedPairs(source=given.source, target=given.target, bounds=bounds, true=given.true)


def faults(trials: list[Trial]) -> list[str]:
    """What must not be: not proved, too slow, above the exhaustive search, a forgery accepted."""
    told: list[str] = []
    for one in trials:
        told += [f"{one.name}: not proved"] * (not one.proved)
        told += [f"{one.name}: too slow"] * (one.search + one.check > SECONDS)
        told += [f"{one.name}: not the least"] * (one.excess is not None and one.excess > 1e-9)
        told += [f"{one.name}: a forgery was accepted"] * (one.forgeries[1] > 0)
    return told


def table(trials: list[Trial]) -> str:
    """A line for each family."""
    lines = [f"{'':24s}   proved  boxes  search s  (most)  check s  (most)"]
    for name in dict.fromkeys(one.name for one in trials):
        some = [one for one in trials if one.name == name]
        proved = f"{sum(one.proved for one in some)}/{len(some)}"
        boxes = float(np.median([one.boxes for one in some]))
        search, check = ([getattr(one, part) for one in some] for part in ("search", "check"))
        numbers = f"{np.median(search):8.3f} {max(search):8.3f} {np.median(check):8.3f}"
        lines.append(f"{name:24s} {proved:>8s} {boxes:6.0f} {numbers} {max(check):7.3f}")
    exhausted = [one.excess for one in trials if one.excess is not None]
    lines.append(f"exhaustive searches: {len(exhausted)}, largest excess {max(exhausted):.1e}")
    made, accepted = (sum(one.forgeries[k] for one in trials) for k in (0, 1))
    lines.append(f"forgeries: {made}, accepted: {accepted}")
    return "\n".join(lines)


def main() -> int:
    """Exit code 1 where a usual problem is not proved, or anything is wrong."""
    instances = int(sys.argv[1]) if len(sys.argv) > 1 else INSTANCES
    trials, harder = usual(instances), hard(max(instances // 10, 1))
    wrong = faults(trials) + [one for one in faults(harder) if "not proved" not in one]
    sys.stdout.write("\n".join([table([*trials, *harder]), *wrong]) + "\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
