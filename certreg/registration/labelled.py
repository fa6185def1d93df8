"""Registrations of pairs that may be wrong: a label for each pair, and the fit over the inliers.

What was sought is one of two parts, the other is Absent: the most pairs, or the least cost.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from certreg.certificate.producing_consensus import ProvedConsensus, pose_of
from certreg.exact.decimals import at_least, at_most
from certreg.exact.dyadic import double_above, double_below
from certreg.geometry.similarity import Similarity
from certreg.problem.arrays import apart
from certreg.registration.exit_codes import DONE, NOT_CERTIFIED, NOT_UNIQUE, worst
from certreg.registration.pair_angles import angles_between
from certreg.registration.pair_warnings import few_warning, reason_against, warnings_of
from certreg.registration.pair_words import (
    headline,
    line_words,
    named_rows,
    open_words,
    others_words,
    ranges_words,
    repeated_rows,
    repeated_words,
    those_within,
)
from certreg.registration.row_names import RowNames
from certreg.results import Absent, Saved

if TYPE_CHECKING:
    from fractions import Fraction

    import numpy as np
    from numpy.typing import NDArray

    from certreg.certificate.consensus import ConsensusBody, ConsensusSimilarityBody
    from certreg.certificate.envelope import Certificate
    from certreg.certificate.truncated import TruncatedRotationBody
    from certreg.equilibrium.equilibrium_set import EquilibriumSet
    from certreg.geometry.pose import Pose
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.covariance import PoseCovariance
    from certreg.registration.misfits import FitWarning
    from certreg.registration.result import Registration
    from certreg.registration.robustness import Robustness
    from certreg.registration.simulation import SimulatedMotion


NO_COUNT = Absent(
    "the least truncated cost was sought, not the most pairs: what is proved is in `truncated`"
)
NO_COST = Absent("the most pairs were sought, not the least truncated cost")
COST_DIGITS = 6  # of a cost in the first line


class ProvedTurn(NamedTuple):
    """A certified rotation, and a bound on sin^2 of half the angle to all that are sought."""

    certified: Sequence[int]
    sin2: Fraction


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LabelledRegistration(Saved, ABC):
    """A registration whose pairs are labelled; the pose is that of the least squares over inliers.

    What a `Registration` says of its pose is said here of the same least squares, `fit`: they are
    no statement about the other pairs.

    Attributes
    ----------
    problem
        As it was stated, with its bounds.
    labels
        Of each pair: "inlier" or "outlier" in every motion that meets as many, or at every optimum:
        proved; or "undecided".
    inliers
        Rows of the pairs within their bounds.
    fit
        The least squares over these rows, with its own proof; row k is `inliers[k]`, also in words.
    certificate
        That the checker has accepted; None where it accepted none.
    verdict
        The checker's.
    timings
        Seconds per phase.
    """

    problem: RegistrationProblem
    labels: tuple[str, ...]
    inliers: NDArray[np.intp]
    fit: Registration
    certificate: Certificate[Any] | None
    verdict: Any
    timings: dict[str, float]

    @property
    def pose(self) -> Pose | Similarity:
        """That of `fit`, as the problem has a scale or not."""
        return self.fit.pose

    @property
    def objective(self) -> float | None:
        """That of `fit`."""
        return self.fit.objective

    @property
    def rmse(self) -> float | None:
        """That of `fit`, in the unit of length."""
        return self.fit.rmse

    @property
    def covariance(self) -> PoseCovariance | None:
        """That of `fit`: as if all inliers were right pairs."""
        return self.fit.covariance

    @property
    def robustness(self) -> Robustness | None:
        """That of `fit`."""
        return self.fit.robustness

    @property
    def equilibria(self) -> EquilibriumSet | Any:
        """Those of `fit`."""
        return self.fit.equilibria

    @property
    def trajectory(self) -> SimulatedMotion | None:
        """That of `fit`."""
        return self.fit.trajectory

    def stated(self, name: str) -> Any:
        """An attribute of `fit`, or the Absent that stands for it."""
        return self.fit.stated(name)

    @property
    def most(self) -> ConsensusRegistration | Absent:
        """With the most pairs that one motion brings within, where these were sought."""
        return NO_COUNT

    @property
    def least(self) -> TruncatedRegistration | Absent:
        """With the least truncated cost, where that was sought."""
        return NO_COST

    @property
    @abstractmethod
    def turn(self) -> ProvedTurn | None:
        """How far the rotations that are sought may be from a certified one, if that is proved."""

    @property
    @abstractmethod
    def unbounded(self) -> str:
        """Why that is not proved, where it is not."""

    @property
    @abstractmethod
    def headline(self) -> str:
        """What is proved, in words."""

    @property
    @abstractmethod
    def exit_code(self) -> int:
        """0: all is proved that was asked for; 3: less; 4: less than the labels, or the optimum."""

    @property
    def residuals(self) -> NDArray[np.float64]:
        """(N,), how far each pair is off at `pose`, in the unit of length."""
        block = self.problem.points
        return apart(self.pose.apply(block.source), block.target)

    @property
    def names(self) -> RowNames:
        """Of the rows."""
        about = {} if self.certificate is None else self.certificate.about
        return RowNames.of(about, self.problem.n)

    @property
    def undecided(self) -> list[int]:
        """The rows of which nothing is proved."""
        return [row for row, word in enumerate(self.labels) if word == "undecided"]

    @property
    def labels_unique(self) -> bool:
        """Whether every label is proved."""
        return "undecided" not in self.labels

    @property
    def few(self) -> FitWarning | None:
        """That the pairs within may agree by chance, where they are few."""
        return None

    @property
    def pair_warnings(self) -> tuple[FitWarning, ...]:
        """What the proof of the labels does not tell of the pairs."""
        return warnings_of(self.few, self.problem, self.fit)

    @property
    def warnings(self) -> tuple[FitWarning, ...]:
        """The same, and those of the least squares."""
        return (*self.pair_warnings, *self.fit.fit.warnings)

    @property
    def against(self) -> str | None:
        """What is to be said in the headline against pairs and pose; None where nothing is."""
        return reason_against(self.fit, self.pair_warnings)

    @property
    def good(self) -> bool:
        """Whether all is proved, and nothing is to be said against pairs and pose."""
        return self.exit_code == DONE and self.against is None

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know of the pairs."""
        again = repeated_rows(self.problem, self.inliers)
        return (repeated_words(again, self.names),) if again else ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConsensusRegistration(LabelledRegistration):
    """The pose of the pairs that are met, and what is proved of every pair.

    Its certificate, "consensus" or "consensus-similarity", holds the proof of the fit.

    Attributes
    ----------
    found
        The witness, the rows that it meets and their labels.
    second
        How many of the other pairs another motion meets, as far as one was found; nothing of it is
        proved. None where fewer than three are left, or met.
    """

    certificate: Certificate[ConsensusBody | ConsensusSimilarityBody]
    found: ProvedConsensus
    second: int | None

    def __repr__(self) -> str:
        word = "labels proved" if self.labels_unique else f"at most {self.upper} proved"
        met = f"{self.lower} of {self.problem.n} pairs within their bounds"
        return f"<{type(self).__name__}: {met}; {word}>"

    @property
    def most(self) -> ConsensusRegistration:
        """These pairs."""
        return self

    @property
    def witness(self) -> Pose | Similarity:
        """A motion that meets all of them, exactly before it is rounded to doubles."""
        rigid = pose_of(self.found.witness)
        if self.scale_interval is None:
            return rigid
        return Similarity(
            rotation=rigid.rotation,
            translation=rigid.translation,
            quaternion_wxyz=rigid.quaternion_wxyz,
            scale=float(self.found.witness.scale),
        )

    @property
    def scale_interval(self) -> tuple[float, float] | None:
        """Between which scales all motions are that meet these pairs, proved; rounded outwards.

        None where the scale is not free.
        """
        scales = self.certificate.body.scales
        return None if scales is None else (double_below(scales[0]), double_above(scales[1]))

    @property
    def undecided_scales(self) -> tuple[tuple[float, float], ...]:
        """With which scales motions may meet as many pairs, or more, but others than these.

        Rounded outwards; an end may be 0 or infinite. None of them where the scale is not free.
        """
        some = [] if self.scale_interval is None else self.found.open_scales
        return tuple(
            (double_below(one.low), math.inf if one.high is None else double_above(one.high))
            for one in some
        )

    @property
    def lower(self) -> int:
        """So many pairs one motion meets, proved."""
        return len(self.inliers)

    @property
    def upper(self) -> int:
        """No motion meets more, proved."""
        return self.found.upper

    @property
    def broken(self) -> tuple[int, ...]:
        """Met rows that the least-squares pose leaves outside of their bounds."""
        off = self.residuals > self.problem.bounds
        return tuple(row for row in self.inliers.tolist() if off[row])

    @property
    def turn(self) -> ProvedTurn | None:
        """How far a motion that meets these pairs may turn from the certified pose of `fit`."""
        body = self.certificate.body
        if body.reach is None or body.fit is None:
            return None
        certified = body.fit.get("proof", body.fit)["pose"]
        return ProvedTurn(certified, body.reach.sin2_half_angle.value)

    @property
    def unbounded(self) -> str:
        """Mostly these pairs are too near to a line for their bounds."""
        rows = self.inliers
        return line_words(self.problem.points.target[rows], self.problem.bounds[rows])

    @property
    def headline(self) -> str:
        """What is proved, in words; where it is not proved of all scales, of which it is."""
        told = headline(self.problem, self.found, self.names, self.against)
        some = self.undecided_scales
        if not some:
            return told
        met, where = self.lower, ranges_words(some)
        others = f"{'any other ' * self.certificate.body.met_elsewhere}{met}"
        return (
            f"{told} With scales {where} it is not proved which {met} are met; with all others "
            f"no motion brings {others} within."
        )

    @property
    def few(self) -> FitWarning | None:
        """That the pairs within may agree by chance, where they are few."""
        again = len(repeated_rows(self.problem, range(self.problem.n)))
        met = self.lower - len(repeated_rows(self.problem, self.inliers))
        return few_warning(met, self.problem.n - again, "different pairs" if again else "pairs")

    @property
    def exit_code(self) -> int:
        """0: all labels proved; 3: the maximum, but not the labels; 4: less; or that of the fit."""
        own = NOT_UNIQUE if self.upper == self.lower else NOT_CERTIFIED
        return worst([DONE if self.labels_unique else own, self.fit.exit_code])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TruncatedRegistration(LabelledRegistration):
    """The rotation of least truncated cost, and what is proved of it and of every pair.

    `fit` is weighed by 1 / bound^2: its rotation is that of the least cost.

    Attributes
    ----------
    cost
        Sum of min((residual / bound)^2, 1) at the rotation, rounded.
    """

    certificate: Certificate[TruncatedRotationBody] | None
    cost: float

    def __repr__(self) -> str:
        counted = f"{self.labels.count('inlier')} of {self.problem.n} inliers"
        return f"<{type(self).__name__}: cost {self.cost:.6g}; {counted}>"

    @property
    def least(self) -> TruncatedRegistration:
        """This cost."""
        return self

    @property
    def unique(self) -> bool:
        """Whether the optimum is proved to be one single rotation."""
        return self.certificate is not None and self.certificate.body.claims.unique

    @property
    def gap(self) -> float | None:
        """The cost exceeds the least one by less, proved; None where nothing is."""
        return None if self.certificate is None else double_above(self.certificate.body.gap)

    @property
    def angles(self) -> NDArray[np.float64]:
        """(N,), radians, between the two points of each pair at `pose`; NaN where one is 0."""
        return angles_between(self.pose.apply(self.problem.source), self.problem.target)

    @property
    def turn(self) -> ProvedTurn | None:
        """How far an optimum may be from the certified rotation."""
        body = None if self.certificate is None else self.certificate.body
        if body is None or body.claims.sin2_half_angle is None:
            return None
        return ProvedTurn(body.quaternion, body.claims.sin2_half_angle.value)

    @property
    def unbounded(self) -> str:
        """Of what is open, the first."""
        if self.certificate is None:
            return "nothing is proved"
        return open_words(self.fit.equilibria.classification.ambiguity, labels=self.labels_unique)

    @property
    def certified(self) -> bool:
        """Whether all labels are proved, and a gap and, if it is unique, an angle in the limits."""
        worth, limits = self.verdict.worth, self.fit.limits
        if self.certificate is None or worth is None or not self.labels_unique:
            return False
        near = not self.unique or (worth.angle is not None and worth.angle <= limits.max_angle)
        return worth.share <= limits.max_gap and near

    @property
    def headline(self) -> str:
        """What is proved, in words."""
        out, worth = self.labels.count("outlier"), self.verdict.worth
        within = those_within(self.labels.count("inlier"), len(self.labels))
        if self.gap is None or worth is None:
            return f"NOT PROVED: a rotation of truncated cost {self.cost:.6g} was found."
        if not self.certified:
            rows = self.undecided
            told = f" ({named_rows(self.names, rows)})" if rows else ""
            cost = at_most(worth.objective, COST_DIGITS)
            return (
                f"PARTLY PROVED: the truncated cost is at most {cost}, and less than "
                f"{at_most(self.gap, 2)} above the least. {within.capitalize()} at every optimum, "
                f"{out} at none; {len(rows)} undecided{told}."
            )
        others = f". {others_words(out)} at EVERY optimum." if out else ": no outliers."
        least = at_least(worth.minimum, COST_DIGITS)
        if self.unique:
            but = "" if self.against is None else f", BUT {self.against}"
            return (
                f"CERTIFIED{but}: no rotation has a smaller truncated cost than {least}, and "
                f"{within} there{others}"
            )
        return (
            f"CERTIFIED, NOT UNIQUE: no rotation has a smaller truncated cost than {least}; one "
            f"single rotation is not proved. {within.capitalize()} at every optimum{others}"
        )

    @property
    def exit_code(self) -> int:
        """0: labels and one rotation proved; 3: the labels alone; 4: less."""
        return (DONE if self.unique else NOT_UNIQUE) if self.certified else NOT_CERTIFIED
