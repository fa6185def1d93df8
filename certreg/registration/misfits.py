"""What a fit is worth: how much it explains, and the usual reasons why it explains little.

An optimum is proved whatever the data are; whether they are pairs of one rigid shape is a question
of statistics, answered here. Throughout: n rows with weight, residuals y - R x - t of variance
sigma^2 / w, Gaussian, and small beside the clouds, so that the fit is linear in the pose. Weights
without a sigma may be relative, the noise of all rows alike: n is then (sum w)^2 / sum w^2, which
is as many rows where all have one weight, and fewer where few rows carry the sums. The least
objective E is then sigma^2 times a chi-squared variable of 3 n - 6 degrees of freedom. Each
warning needs two things: a probability below LEVEL if the pairs are right, and a size that
matters, since a test alone finds every millionth of a scale in a million points.

Let a model with k more parameters, or a model of as many but wrong, leave the share b of E. The
share that its free parameters leave of pure noise is a beta variable, which gives the bounds:

- scale: E_s / E ~ Beta((3 n - 7) / 2, 1 / 2), Student's test with 3 n - 7 degrees.
- outlier rows: k given rows left out: Beta((3 (n - k) - 6) / 2, 3 k / 2). The rows are found from
  the data, so all n over k sets count, and all k: the bound times k (k + 1) (n over k).
- mirrored: a wrong model leaves noise and a vector that does not depend on it: its least
  objective is no smaller, in distribution, than a chi-squared variable of as many degrees as E
  has. That one is at most b E is bounded whatever links the two, so noise of both clouds is
  included: P(chi2 <= c) + P(chi2 >= c / b), for every c.
- shuffled: the same for a pairing that a slip makes, three of them. Else: explained < 1/2, which
  takes an RMSE above three quarters of the size. With right pairs E <= e sqrt(Sxx Syy) gives
  R >= 1 - e / 2.
- chi2: E / sigma^2 >= the value found: the chi-squared distribution.
- poor-fit: explained < 1/2, as for shuffled.

`benchmarks/rates/fit_warnings.py` measures all of this, with noise up to a tenth of the size, too.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import cached_property
from certreg.exact.dyadic import nearest_or_zero, power_of_two
from certreg.exact.elimination import rank
from certreg.geometry.so3 import squared_norm
from certreg.problem.bounds import MOST_PAIRS
from certreg.problem.moments import trace
from certreg.registration.outlying import PAIRINGS, ROUNDING, OtherPairing, RowFit
from certreg.registration.tail_probabilities import log_beta_below, log_choices, log_ratio_below
from certreg.registration.units import UNITS
from certreg.results import Brief

if TYPE_CHECKING:
    from certreg.objective.isotropic import Isotropic
    from certreg.problem.motion import Motion
    from certreg.registration.row_names import RowNames

LEVEL = 1e-6  # of each test; a hundredth of what is promised, for what is not linear
MOST_LEFT = Fraction(1, 2)  # of E by a remedy: real clouds often have a certain scale, for 1 % of E
LEAST_EXPLAINED = Fraction(1, 2)
MIRROR_EXPLAINED = Fraction(9, 10)  # by a reflection
ALIKE = 0.2  # of the size: lengths along the axes of two clouds of one shape, a tenth of it noise
CHANCE = 1e-3  # random pairings that may be as good as a shuffled one
RANDOM_PAIRINGS = 4096
SMALL = 1e-3  # off one: a scale whose digits are in what it is off
FEWER = 2.0  # a part of the rows fits better than all rows: by this much, to be the cause
UNIT_SLACK, NAMED_AGAIN = 0.01, 3  # off a ratio of units that may be the cause; rows in a remedy


class FitCode(enum.Enum):
    """What is wrong with a fit; the value is the word used in files."""

    SCALE = "scale"
    OUTLIER_ROWS = "outlier-rows"
    SHUFFLED = "shuffled"
    MIRRORED = "mirrored"
    CHI2 = "chi2"
    POOR_FIT = "poor-fit"
    FEW_PAIRS = "few-pairs"  # these two of pairs that may be wrong: `pair_warnings`
    WIDE_BOUND = "wide-bound"


REMEDIES = {  # where the numbers of a fit add nothing to them
    FitCode.SHUFFLED: (
        "check that row k of both clouds is one pair, or give labels to both: they pair rows in "
        "any order"
    ),
    FitCode.MIRRORED: (
        "check the signs and the order of the axes in both; if one is mirrored, mend it and "
        "certify again"
    ),
    FitCode.POOR_FIT: (
        "check the pairs, and whether both clouds show one rigid shape; where many pairs may be "
        "wrong, sort them out first"
    ),
    FitCode.CHI2: "mend first what else is warned of: it may be all, and sigma right",
}
PROVE_WRONG = (
    "; or give --max-residual, how far apart a right pair may be, to prove which are wrong"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FitWarning(Brief):
    """Something about the data that a pose cannot mend, in a sentence without a full stop.

    remedy: what may be done about it, in another such sentence; no more is known than `text` says.
    """

    code: FitCode
    text: str
    remedy: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ChiSquared:
    """The objective where sigma was given: chi-squared with `dof` degrees of freedom.

    p: the probability of at least this value if the noise is Gaussian with this sigma. bound:
        whether `dof` and p are no more than upper bounds, as sigma leaves a turn open.
    """

    value: float
    dof: int
    p: float
    bound: bool = False


@dataclass(frozen=True)
class FitSums:
    """What the exact moments say of the optimum: Fractions, in units of the objective."""

    objective: Isotropic

    @cached_property
    def source(self) -> Fraction:
        """Sxx, the sum of w |x - mean|^2."""
        moments = self.objective.moments
        unit = power_of_two(moments.weight_exponent + 2 * moments.source_exponent)
        return trace(moments.source_scatter) * unit / moments.mass

    @cached_property
    def free_turns(self) -> int:
        """How many numbers of a rotation move nothing: all about a point, one about a line."""
        return (3, 1, 0, 0)[rank(self.objective.moments.source_scatter)]

    @cached_property
    def target(self) -> Fraction:
        """Syy, the sum of w |y - mean|^2."""
        return self.objective.moments.spread - self.source

    @cached_property
    def alignment(self) -> Fraction:
        """tr(R^T C) at the optimum."""
        return self.objective.alignment(self.objective.optimum)

    @cached_property
    def energy(self) -> Fraction:
        """E, the least objective."""
        return self.objective.moments.spread - 2 * self.alignment

    @cached_property
    def mirrored_share(self) -> Fraction:
        """What a reflection and the best rotation leave of E: -K takes the place of K."""
        left = self.objective.moments.spread + 2 * self.objective.eigenvalues[-1]
        return max(Fraction(0), left) / self.energy

    @cached_property
    def explained(self) -> Fraction | None:
        """R^2; None where a cloud is a point."""
        return self._explained(self.alignment)

    @cached_property
    def mirrored_explained(self) -> Fraction | None:
        """R^2 after a reflection."""
        return self._explained(self.objective.eigenvalues[-1])

    @cached_property
    def scale(self) -> Fraction | None:
        """The best scale, tr(R^T C) / Sxx; None where the source is a point."""
        return self.alignment / self.source if self.source else None

    @cached_property
    def scaled_share(self) -> Fraction:
        """What the best scale leaves of E: (Syy - (tr R^T C)^2 / Sxx) / E."""
        return (self.target - self.alignment**2 / self.source) / self.energy

    @cached_property
    def rounded(self) -> bool:
        """Whether the residuals are at the rounding of the clouds, or of their offsets."""
        return self.energy <= self.rounding

    @cached_property
    def rounding(self) -> Fraction:
        """The objective of residuals at rounding."""
        moments = self.objective.moments
        here, there = squared_norm(moments.source_sum), squared_norm(moments.target_sum)
        offset = here * power_of_two(2 * moments.source_exponent)
        offset += there * power_of_two(2 * moments.target_exponent)
        offset *= power_of_two(moments.weight_exponent) / moments.mass
        return Fraction(ROUNDING) ** 2 * moments.spread + power_of_two(-102) * offset

    def _explained(self, alignment: Fraction) -> Fraction | None:
        return alignment**2 / (self.source * self.target) if self.source and self.target else None


def misfits(
    sums: FitSums, rows: RowFit, chi2: ChiSquared | None, names: RowNames
) -> tuple[FitWarning, ...]:
    """The warnings of a fit whose residuals are above rounding."""
    causes = {
        FitCode.OUTLIER_ROWS: _outlier_words(rows, names),
        FitCode.SHUFFLED: _slip_words(rows),
        FitCode.MIRRORED: _mirrored_words(sums, rows),
    }
    texts = {FitCode.SCALE: _scale_words(sums, rows), **_likeliest(causes, sums, rows)}
    if FitCode.MIRRORED not in texts:  # a reflection that fits pairs the rows as they are
        texts.setdefault(FitCode.SHUFFLED, _shuffled_words(sums, rows))
    texts[FitCode.CHI2] = chi2_words(chi2)
    if not any(texts.values()):
        texts[FitCode.POOR_FIT] = _poor_words(sums)
    told = {code: text for code, text in texts.items() if text}
    alone = chi2 if len(told) == 1 else None
    return tuple(
        FitWarning(code=code, text=text, remedy=_remedy(code, sums, rows, (alone, names)))
        for code, text in told.items()
    )


def _remedy(
    code: FitCode, sums: FitSums, rows: RowFit, about: tuple[ChiSquared | None, RowNames]
) -> str:
    """What may be done: in the words of "check" and "if", since a test is no proof of a cause.

    about: chi-squared where it alone is warned of, and names of the rows.
    """
    chi2, names = about
    if code is FitCode.SCALE:
        return _scale_remedy(sums.scale)
    if code is FitCode.OUTLIER_ROWS:
        return _outlier_remedy(rows, names)
    if code is FitCode.CHI2 and chi2 is not None:
        return chi2_remedy(chi2)
    return REMEDIES[code]


def chi2_remedy(chi2: ChiSquared) -> str:
    """What may be done where nothing else is warned of."""
    shape = "check the pairs, and whether both clouds show one rigid shape"
    return f"{shape}; if the noise may be larger, give {_times_sigma(chi2)} times this sigma"


def _scale_remedy(scale: Fraction | None) -> str:
    """The factor that makes the target as large as the source: of units, if it may be theirs."""
    times = nearest_or_zero(1 / scale) if scale else 0.0
    unit = _unit_near(times)
    if unit is not None:
        return f"if the units differ, multiply the target by {unit[0]:.6g} and certify again"
    digits = 12 if abs(times - 1.0) < SMALL else 6
    factor = f" by {times:.{digits}g}" if 0.0 < times < math.inf else ""
    return f"if the sizes may differ, certify with --scale, or multiply the target{factor}"


def _outlier_remedy(rows: RowFit, names: RowNames) -> str:
    if rows.tied:
        return (
            "check all pairs, whether both clouds show one rigid shape, and whether one is "
            "mirrored; more right pairs may tell"
        )
    k = rows.far_rows
    which = names.words(rows.far, k) if k <= NAMED_AGAIN else "these rows"
    they, them = ("it is", "it") if k == 1 else ("they are", "them")
    remedy = f"check {which}; if {they} wrong, mend {them} or leave {them} out, and certify again"
    return f"{remedy}{PROVE_WRONG}" if rows.rows <= MOST_PAIRS else remedy


def _likeliest(
    causes: dict[FitCode, str | None], sums: FitSums, rows: RowFit
) -> dict[FitCode, str]:
    """Of causes that exclude each other the one that leaves least: what is left of E."""
    other = rows.other_pairing
    left = {
        FitCode.OUTLIER_ROWS: FEWER * (rows.left + ROUNDING),
        FitCode.SHUFFLED: 1.0 if other is None else other.left,
        FitCode.MIRRORED: float(sums.mirrored_share),
    }
    told = {code: text for code, text in causes.items() if text}
    best = min(told, key=lambda code: left[code], default=None)
    return {} if best is None else {best: told[best]}


def _poor_words(sums: FitSums) -> str | None:
    if sums.explained is None or sums.explained >= LEAST_EXPLAINED:
        return None
    return (
        f"the best rotation, translation and scale explain {_percent(sums.explained)} of the "
        "target: pairs are wrong (one that is far off is enough), the clouds are not one rigid "
        "shape, or the noise is large beside them"
    )


def _scale_words(sums: FitSums, rows: RowFit) -> str | None:
    if sums.scale is None or sums.explained is None or sums.explained < LEAST_EXPLAINED:
        return None
    log_p = log_scale_p(sums, rows)
    if log_p is None or log_p > math.log(LEVEL) or sums.scaled_share > MOST_LEFT:
        return None
    return (
        f"taken as {_times_words(sums.scale)}, the target fits better: with this scale "
        f"{_percent(1 - sums.scaled_share)} of the squared residuals are gone"
    )


def _times_words(scale: Fraction) -> str:
    """How large the target is beside the source; by how much where that is little."""
    off = float(abs(scale - 1)) if abs(scale - 1) < SMALL else math.inf
    if off < SMALL:
        which = "larger" if scale > 1 else "smaller"
        return f"{which} than the source by {off:.3g} of its size ({1e6 * off:.3g} ppm)"
    times = nearest_or_zero(scale)
    if not 0 < times < math.inf:
        return f"{'over 1e+308' if times else 'under 1e-308'} times as large as the source"
    unit = _unit_near(times)
    units = "" if unit is None else f" ({unit[1]}?)"
    return f"{times:.6g} times as large as the source{units}"


def log_scale_p(sums: FitSums, rows: RowFit) -> float | None:
    """The log of the p-value of a scale other than one; None where nothing is left to test."""
    degrees = rows.degrees(1)
    if sums.explained is None or degrees <= 0 or sums.rounded:
        return None
    return log_beta_below(float(sums.scaled_share), degrees / 2, 0.5)


def _outlier_words(rows: RowFit, names: RowNames) -> str | None:
    k, n = rows.far_rows, rows.rows
    degrees, gone = rows.degrees(3 * k), _gone(rows.left)
    if k == 0 or degrees <= 0 or 2 * k >= n:
        return None
    log_p = log_beta_below(rows.left, degrees / 2, 3 * k / 2)
    if log_p + log_choices(n, k) + math.log(k * (k + 1)) > math.log(LEVEL):
        return None
    if rows.tied:
        return (
            f"{n - k} of {n} rows lie within six medians of one pose, at least as many of another: "
            f"their number does not tell which are right; without {k} of them {gone}"
        )
    does, them = ("does", "it") if k == 1 else ("do", "them")
    return (
        f"{names.counted(rows.far, k)}, {does} not fit the best pose of the others: "
        f"without {them} {gone}"
    )


def _mirrored_words(sums: FitSums, rows: RowFit) -> str | None:
    degrees = rows.degrees()
    explained, left = sums.mirrored_explained, sums.mirrored_share
    if degrees <= 0 or explained is None or explained < MIRROR_EXPLAINED or left > MOST_LEFT:
        return None
    if log_ratio_below(float(left), degrees) > math.log(LEVEL):
        return None
    return (
        "the target fits a mirror image of the source better: a reflection explains "
        f"{_percent(explained)} of it, the best rotation {_percent(sums.explained)}: "
        "is an axis flipped, or are two swapped?"
    )


def _slip_words(rows: RowFit) -> str | None:
    other = rows.other_pairing
    if other is None or not _fits_better(other, rows.motion):
        return None
    of = "" if other.first is None else f" of the first {other.first} rows"
    gone = _gone(other.left, of)
    return f"with the target {other.words} {gone}: are the rows out of step?"


def _shuffled_words(sums: FitSums, rows: RowFit) -> str | None:
    if sums.explained is None or sums.explained >= LEAST_EXPLAINED or not _as_random(sums, rows):
        return None
    return (
        f"the rows explain {_percent(sums.explained)} of the target, as a random pairing might (an "
        f"estimate: more than one in {round(1 / CHANCE)} would explain as much), though the clouds "
        "are about as long and wide: is one of them, or a part of it, in another order?"
    )


def _fits_better(other: OtherPairing, motion: Motion) -> bool:
    """Whether another pairing fits better than chance allows if the given one is right."""
    degrees = motion.degrees(3 * other.rows)
    if degrees <= 0 or other.left > MOST_LEFT:
        return False
    return log_ratio_below(other.left, degrees) + math.log(PAIRINGS) <= math.log(LEVEL)


def _as_random(sums: FitSums, rows: RowFit) -> bool:
    """Whether the clouds have one shape, and CHANCE of random pairings may fit as well, or more.

    Over random pairings C has mean 0 and covariance Syy x Sxx / (N - 1), with as many rows as count
    effectively; it is taken as Gaussian. Rotations of either cloud change no singular value.
    """
    here, there = rows.second_moments
    longer = abs(np.sqrt(here) - np.sqrt(there))
    if not longer.max() <= ALIKE:  # nor if one is not a number: a point has no shape
        return False
    rng = np.random.default_rng(0)
    spread = np.outer(there / there.sum(), here) / max(rows.effective_rows - 1.0, 1.0)
    crosses = rng.standard_normal((RANDOM_PAIRINGS, 3, 3)) * np.sqrt(spread)
    values = np.linalg.svd(crosses, compute_uv=False)
    signs = np.sign(np.linalg.det(crosses))
    alignments = values[:, 0] + values[:, 1] + signs * values[:, 2]
    found = math.sqrt(float(sums.explained or 0))
    return int(np.count_nonzero(alignments >= found)) > CHANCE * RANDOM_PAIRINGS


def chi2_words(chi2: ChiSquared | None) -> str | None:
    """That the residuals are larger than sigma says, where they are."""
    if chi2 is None or chi2.p > LEVEL:
        return None
    return (
        f"the residuals are {_times_sigma(chi2)} times what sigma says (chi-squared "
        f"{chi2.value:.6g} with {chi2.dof} degrees of freedom), which independent Gaussian noise "
        "of this sigma gives less than once in a million times"
    )


def _times_sigma(chi2: ChiSquared) -> str:
    """How large residuals are beside sigma, with the digits in which that differs from one."""
    times = math.sqrt(chi2.value / chi2.dof)
    if times >= 1.1:
        return f"{times:.3g}"
    return f"{times:.{1 - math.floor(math.log10(times - 1.0))}f}"


def _unit_near(scale: float) -> tuple[float, str] | None:
    """The ratio of two units that a scale is near, whichever is the target's, and their names."""
    ratios = [(ratio, words) for k, words in UNITS.items() for ratio in (k, 1.0 / k)]
    return next((one for one in ratios if abs(scale / one[0] - 1.0) < UNIT_SLACK), None)


def _gone(left: float, of: str = "") -> str:
    """What share of the squared residuals goes if this one stays."""
    return f"{_percent(1 - Fraction(left))} of the squared residuals{of} are gone"


def _percent(share: Fraction | float | None) -> str:
    """A share in per cent, never rounded up to 100."""
    percent = 100.0 * float(share or 0)
    return "over 99.9 %" if percent >= 99.95 and share != 1 else f"{percent:.3g} %"
