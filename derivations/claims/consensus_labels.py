"""Claim: what the pairs that are left say of every motion that brings many within their bounds."""

from __future__ import annotations

from collections.abc import Sequence

from certreg.verify import ConsensusStatement, RefusalError

from ..algebra import facts, nonnegative, positive
from ..hypothesis import Hypothesis, Standing, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof
from ..notation import scalar

MET, LEAST, LEFT, OTHERS = (scalar(name) for name in ("m", "K", "c", "d"))
NEXT, LATER, MOST, MANY = (scalar(name) for name in ("k", "c'", "u", "b"))

INSIDE = nonnegative_by(
    r"All $m$ pairs are in $C$, which has $c$.", LEFT - MET, standing=Standing.CASE
)
TIGHT = nonnegative_by(
    r"$c \le K$.", LEAST - LEFT, standing=Standing.CASE, example={LEFT: 4, MET: 4, LEAST: 3}
)
WITHOUT = nonnegative_by(
    r"The motion does not bring $i$ within: its $m \ge K$ pairs are among the $d$ that are left.",
    OTHERS - MET,
    standing=Standing.CASE,
)
EITHER = nonnegative_by(
    r"Where $m \ge k$, all are among the $c'$ pairs that are left for $k$, and else $m \le k - 1$: "
    r"$m \le b\,c' + (1 - b)\,(k - 1)$ with $b = 1$ or $0$.",
    MANY * LATER + (1 - MANY) * (NEXT - 1) - MET,
    prepare=lambda point: {MET: min(point[LATER], point[NEXT] - 1)},
    example={MET: 1},
)
ONE_OF_TWO = nonnegative_by(
    r"$0 \le b \le 1$.", [MANY, 1 - MANY], example={MANY: 2, LATER: 1, MET: 2, MOST: 1, NEXT: 1}
)
BASE = ((0, 0, 0), (6, 0, 0), (0, 6, 0), (0, 0, 6))  # they are their own targets
MIRRORED, WRONG = ((2, 2, 4), (2, 2, -4)), ((9, 9, 9), (-20, 0, 0))
GROUP = [[0, 1, 2], [1, 1, 1, 1]]


def _too_few(strict: bool) -> Hypothesis:  # noqa: FBT001  (which of two conditions)
    says = r"Of $C$ without $i$ fewer than $K$ pairs are left: $d < K$."
    by = positive_by if strict else nonnegative_by
    example = {LEAST: 3, OTHERS: 3, MET: 3}
    return by(says, LEAST - OTHERS, standing=Standing.CASE, example=example)


def _most_by(below: int) -> Hypothesis:
    return nonnegative_by(
        r"$u = \max(k - 1, c')$.",
        [MOST - NEXT + below, MOST - LATER],
        example={LATER: 1, MET: 1},
    )


SMALL, LARGEST = _too_few(strict=True), _most_by(1)


def proof(*, strict: bool = True, below: int = 1, labels: str = "iiiioo") -> Proof:
    """Outliers; inliers; the bound; the checker."""
    yield nonnegative(
        "Claims `few_neighbours`, `few_colours`, `weighted_refutation` and "
        "`cliques_without_groups` strike no pair that is "
        r"within its bound under a motion with $m \ge K$ pairs within: all $m$ are in $C$, and "
        "the pairs outside are outliers in every such motion. The witness is such a motion. So "
        r"if $c$ is just $K$, then $m \le K$, so that $m = K$ is the maximum, and every such "
        "motion brings all of $C$ within and no other pair.",
        LEAST - MET,
        [[INSIDE[0]], [TIGHT[0]]],
    )
    small = SMALL if strict else _too_few(strict=False)
    yield positive(
        "Let $d < K$ pairs be left of $C$ without $i$. A motion that does not bring $i$ within "
        r"has all its pairs among these: $m \le d < K$. So every motion with $m \ge K$ brings $i$ "
        "within: an inlier.",
        LEAST - MET,
        [[WITHOUT[0]], [small[0]]],
    )
    largest = LARGEST if below == 1 else _most_by(below)
    yield nonnegative(
        r"Let $c'$ pairs be left of $C$ for a number $k \ge K$, and $u = \max(k - 1, c')$. A "
        r"motion with $m \ge k$ has all its pairs among them, $m \le c' \le u$; one with fewer has "
        r"$m \le k - 1 \le u$. So no motion brings more than $u$ within.",
        MOST - MET,
        [[ONE_OF_TWO[0], largest[1]], [ONE_OF_TWO[1], largest[0]], [EITHER[0]]],
    )
    yield from _checked(labels)


def rows() -> list[list[int]]:
    """Six pairs with bounds of 1, as the checker has them: source, target, weight, bound."""
    pairs = [*((x, x) for x in BASE), MIRRORED, WRONG]
    return [[*x, *y, 1, 1] for x, y in pairs]


def accepted(labels: str, upper: int, stages: Sequence[object]) -> bool:
    """Whether the checker accepts these claims, with the identity for a witness."""
    statement = ConsensusStatement(
        n=6,
        data=None,
        digest="",
        quaternion=(1, 0, 0, 0),
        shift=(0, 0, 0, 0),
        labels=labels,
        upper=upper,
        stages=[*stages],
        fit=None,
        sin2_half_angle=None,
        tau=None,
        springs=None,
    )
    try:
        return statement.prove(rows(), 0, equal=True).verified
    except RefusalError:
        return False


def _checked(labels: str) -> Proof:
    plain, struck = [4, 6, []], [4, 6, [[4, GROUP]]]
    yield facts(
        "`certreg.verify.ConsensusStatement.prove`, the whole checker of such certificates, on "
        r"six pairs with $\beta = 1$: $0$, $6 e_1$, $6 e_2$, $6 e_3$ are their own targets, $(2, "
        "2, 4)$ goes to its mirror image $(2, 2, -4)$, the last one anywhere. The identity "
        "brings $K = 4$ within. The fifth is struck by a group, the first three together: all "
        "labels are proved, and that $4$ is the maximum. It refuses one label more, a lower "
        "maximum, the labels without the group or without any stage.",
        [
            accepted(labels, 4, [struck]),
            accepted("iiiiio", 4, [struck]),
            accepted(labels, 3, [struck]),
            accepted(labels, 4, [plain]),
            accepted(labels, 6, []),
        ],
        [True, False, False, False, False],
    )
    alone = [plain, *([4, i, []] for i in range(3))]
    yield facts(
        "Without the group five are left, the first three with four neighbours each. Of what is "
        "left without one of these too few are left: inliers. Of the fourth and the fifth the "
        "labels are not decided. For $k = 5$ nothing is left: again $4$ is the maximum.",
        [
            accepted("iii??o", 4, [*alone, [5, 6, []]]),
            accepted("iii??o", 4, alone),
            accepted("iii??o", 5, alone),
            accepted("iiii?o", 5, [*alone, [4, 3, []]]),
            accepted("??????", 6, []),
        ],
        [True, False, True, False, True],
    )


CLAIM = Claim(
    name="consensus_labels",
    title="What pairs that are left say",
    statement="Let a rigid motion bring $K$ pairs within their bounds, and let $C$ be the pairs "
    "left of all after strikes for $K$. Every pair outside of $C$ is an outlier in every motion "
    "that brings $K$ pairs or more within; if $C$ has no more than $K$ pairs, each such motion "
    "brings just $C$ within. If of $C$ without $i$ fewer than $K$ are left after strikes for "
    "$K$, each such motion brings $i$ within. If $c'$ pairs are left of $C$ after strikes for $k "
    r"\ge K$, no motion brings more than $\max(k - 1, c')$ within.",
    concludes=tuple(range(1, 6)),
    hypotheses=(INSIDE, TIGHT, WITHOUT, SMALL, LARGEST, EITHER, ONE_OF_TWO),
    setting=("A motion brings $m$ pairs within.",),
    source="elementary",
    proof=proof,
    controls={
        "as many as K left without an inlier": Mutation(
            at=2, proof=lambda: proof(strict=False), point={LEAST: 3, OTHERS: 3, MET: 3}
        ),
        "a maximum below k - 1": Mutation(
            at=3, proof=lambda: proof(below=2), point={NEXT: 2, MET: 1}
        ),
        "a mirror image for an inlier": Mutation(at=4, proof=lambda: proof(labels="iiii?i")),
    },
    not_claimed="That a pair which is not decided is in doubt: perhaps strikes would be found. "
    "That the targets are right: a maximum of wrong pairs is a maximum, too.",
    needs=("few_neighbours", "few_colours", "weighted_refutation", "cliques_without_groups"),
    runs=("certreg.verify.ConsensusStatement.prove", "certreg.verify.LabelledStatement.met"),
    used_by=("certreg.certificate.producing_consensus.ConsensusProver",),
    not_in_coq="All of it: the checker in Coq reads no bounds of pairs.",
)
