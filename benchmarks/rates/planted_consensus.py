"""No pair of a planted consensus is ever struck.

    make rates NAME=planted_consensus ARGS="[COUNT [FIRST]]"

Instances FIRST, FIRST + 1, ...; each has its seed.

Each instance has pairs that one known motion brings within their bounds, the residual of one or of
all on the bound itself, as far as doubles go; the others are at random, just outside of their
bounds, mirror images, or further targets of a planted source point. Clouds are thin, flat, on a
line or solid, in sizes from 1e-6 to 1e6, some a hundred million sizes from the origin, some with
rounded coordinates, some with a bound for each pair. A set of K pairs is met, so whatever strikes
rows that no motion meets together with K - 1 others must leave all of it: the graph and thinning of
the prover, and, of every tenth, those of the checker, whose graph must be the same. Of every
hundredth a certificate with that motion as witness is made, and must be accepted.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from fractions import Fraction
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.certificate.clique_refutation import Assuming
from certreg.certificate.consistency import ConsistentPairs
from certreg.certificate.edge_elimination import MOST_TURNED, Parting
from certreg.certificate.producing_consensus import ConsensusProver, consensus_certificate
from certreg.certificate.vertex_elimination import Graph, GraphThinning
from certreg.native.bitset_graph import mask_of
from certreg.problem.losses import Consensus
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from certreg.native.bitset_graph import BitRows


INSTANCES = 100_000
TOLD = 2_000  # instances between two lines
CHECKED, PROVED = 10, 100  # one in so many is asked of the checker, or proved altogether
EDGE = 1e-9  # of a bound: how far inside the planted residuals are
checker: Any = import_module("certreg.verify")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Planted:
    """A problem, the rows that a motion meets for certain, and that motion."""

    problem: RegistrationProblem
    rows: tuple[int, ...]
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]


def planted(seed: int) -> Planted:
    """An instance; always the same of a seed."""
    rng = np.random.default_rng(seed)
    met, others = int(rng.integers(4, 13)), int(rng.integers(1, 13))
    x = rng.uniform(-1.0, 1.0, (met + others, 3)) * rng.choice([1.0, 1.0, 1e-2, 1e-6, 0.0], 3)
    x += rng.uniform(-1.0, 1.0, x.shape) * (1e-3 * (rng.random() < 0.2))
    if not x.any():
        x[:, 0] = rng.uniform(-1.0, 1.0, len(x))
    size = 10.0 ** rng.integers(-6, 7)
    x = (x + rng.choice([0.0, 1e8]) * rng.uniform(-1.0, 1.0, 3) * (rng.random() < 0.3)) * size
    q = [int(k) for k in rng.integers(-9, 10, 4)]
    q = q if any(q) else [1, 0, 0, 0]
    R, t = rotation(q), rng.uniform(-1.0, 1.0, 3) * size * 10.0 ** rng.integers(0, 3)
    beta = size * float(10.0 ** rng.uniform(-3.0, -0.4))
    bounds = beta * (rng.uniform(0.3, 1.0, len(x)) if rng.random() < 0.3 else np.ones(len(x)))
    ways = rng.standard_normal(x.shape)
    ways *= ((1.0 - EDGE) * bounds / np.linalg.norm(ways, axis=1))[:, None]
    if seed % 2:
        apart(rng, x @ R.T, ways, bounds)
    y = x @ R.T + t + ways * (rng.random(len(x)) < rng.choice([0.3, 1.0]))[:, None]
    wrong(rng, x, y, met, (R, t, bounds))
    if rng.random() < 0.3:
        x, y = (np.round(part / size, 3) * size for part in (x, y))
    bounds[:met] = np.maximum(bounds[:met], residuals_above(x[:met], y[:met], q, t))
    if rng.random() < 0.5:
        bounds[:] = bounds[:met].max()
    order = rng.permutation(len(x))
    problem = RegistrationProblem(x[order], y[order])
    rows = tuple(np.flatnonzero(order < met).tolist())
    stated = problem.under(Consensus(bounds[order]))
    return Planted(problem=stated, rows=rows, rotation=R, translation=t)


def apart(rng: np.random.Generator, turned: Any, ways: Any, bounds: Any) -> None:
    """Errors along the line between two points, which change its length by both bounds."""
    for k in range(0, len(ways) - 1, 2):
        line = turned[k + 1] - turned[k]
        length = float(np.linalg.norm(line))
        if length > 0.0:
            line *= rng.choice([-1.0, 1.0]) * (1.0 - EDGE) / length
            ways[k], ways[k + 1] = -bounds[k] * line, bounds[k + 1] * line


def wrong(rng: np.random.Generator, x: Any, y: Any, met: int, motion: Any) -> None:
    """The pairs from `met` on, in place: near their bounds or not, mirrored, or doubled."""
    R, t, bounds = motion
    centre, spread = x[:met].mean(axis=0), np.abs(x[:met] - x[:met].mean(axis=0)).max()
    for k in range(met, len(x)):
        way = rng.integers(4)
        if way == 0:
            y[k] = R @ centre + t + rng.uniform(-1.5, 1.5, 3) * spread
        elif way == 1:
            off = rng.standard_normal(3)
            off *= bounds[k] * (1.0 + 10.0 ** rng.uniform(-9.0, 0.5)) / np.linalg.norm(off)
            y[k] = R @ x[k] + t + off
        elif way == 2:
            axis = rng.integers(3)
            mirrored = x[k].copy()
            mirrored[axis] = 2.0 * centre[axis] - mirrored[axis]
            y[k] = R @ mirrored + t
        else:
            x[k] = x[rng.integers(met)]
            y[k] = R @ x[k] + t + rng.standard_normal(3) * bounds[k]


def rotation(q: list[int]) -> NDArray[np.float64]:
    """R(q)."""
    w, x, y, z = (float(k) / sum(c * c for c in q) ** 0.5 for k in q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def residuals_above(x: Any, y: Any, q: list[int], t: Any) -> list[float]:
    """Of each pair the least double, or the next, that its exact residual does not exceed."""
    w, *v = q
    norm, shift = sum(k * k for k in q), [Fraction(float(k)) for k in t]
    found: list[float] = []
    for a, b in zip(x.tolist(), y.tolist(), strict=True):
        point = [Fraction(k) for k in a]
        turned = crossed(v, [c + w * k for c, k in zip(crossed(v, point), point, strict=True)])
        square = sum(
            (Fraction(p) - s - k - 2 * c / norm) ** 2
            for p, s, k, c in zip(b, shift, point, turned, strict=True)
        )
        bound = float(square) ** 0.5
        while Fraction(bound) ** 2 < square:
            bound = float(np.nextafter(bound, np.inf))
        found.append(bound)
    return found


def crossed(a: Any, b: Any) -> list[Any]:
    """The cross product."""
    return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]


def faults(seed: int) -> Iterator[str]:
    """What is wrong with an instance."""
    case = planted(seed)
    problem, rng, all_rows = case.problem, np.random.default_rng(seed), (1 << case.problem.n) - 1
    pairs, mine = ConsistentPairs.of(problem), mask_of(case.rows)
    near = pairs.near()
    if any(mine & ~(near[i] | 1 << i) for i in case.rows):
        yield f"{seed}: two planted pairs are no neighbours"
    K = max(3, len(case.rows) - int(rng.integers(3)))
    few = rng.permutation(list(case.rows))[: int(rng.integers(1, K + 1))].tolist()
    graph = Graph(near, pairs.points(), 0.3, turned=MOST_TURNED)
    thinning = GraphThinning(graph, all_rows, K, mask_of(few))
    thinning.run()
    assuming, parting = Assuming(thinning), Parting(thinning)
    while (parting.run() if seed % 2 else assuming.run()) or parting.run(assuming.given_up):
        thinning.run()
    if mine & ~thinning.left.alive:
        yield f"{seed}: a planted pair is struck of {K}"
    if any(mine & ~(thinning.left.near[i] | 1 << i) for i in case.rows):
        yield f"{seed}: two planted pairs are struck together of {K}"
    if seed % CHECKED == 0:
        yield from checked(seed, case, near, thinning, K)


def checked(
    seed: int, case: Planted, near: BitRows, thinning: GraphThinning, K: int
) -> Iterator[str]:
    """What the checker says of it."""
    problem, n = case.problem, case.problem.n
    content = problem.data_bytes()[len(checker.CONSENSUS) + 8 :]
    rows, _ = checker.bounded_rows(content, n)
    if checker.consistent(rows) != near.integers:
        yield f"{seed}: the graphs differ"
    steps, looks = [strike.to_fields() for strike in thinning.strikes], [checker.LOOKS_MAX]
    again = checker.Thinning(rows, [*near], (1 << n) - 1, K, looks, rigid=True)
    if again.after(steps) != thinning.left.alive or again.near != [*thinning.left.near]:
        yield f"{seed}: the checker leaves other rows"
    if seed % PROVED == 0:
        yield from proved(seed, case)


def proved(seed: int, case: Planted) -> Iterator[str]:
    """What is wrong with a certificate."""
    problem = case.problem
    found = ConsensusProver(problem, effort=0.3).prove(case.rotation, case.translation)
    if found is None:
        return
    if len(found.met) <= len(case.rows) and any(found.labels[i] == "o" for i in case.rows):
        yield f"{seed}: a planted pair is labelled an outlier"
    if found.upper < len(case.rows):
        yield f"{seed}: no more than {found.upper} pairs, it is said"
    outcome = checker.check(consensus_certificate(problem, found, None).to_json())
    if not outcome.verified:
        yield f"{seed}: refused: {outcome.reason}"


def main() -> int:
    """Exit code 1 where a planted pair is lost, or a certificate refused."""
    given = [int(text) for text in sys.argv[1:3]]
    count, first = (given + [INSTANCES, 0][len(given) :])[:2]
    wrong_ones: list[str] = []
    for k in range(first, first + count):
        wrong_ones += faults(k)
        if (k + 1 - first) % TOLD == 0:
            sys.stdout.write(f"{k + 1 - first} of {count}: {len(wrong_ones)} faults\n")
            sys.stdout.flush()
    sys.stdout.write(
        "\n".join([*wrong_ones, f"{count} instances, {len(wrong_ones)} faults"]) + "\n"
    )
    return 1 if wrong_ones else 0


if __name__ == "__main__":
    sys.exit(main())
