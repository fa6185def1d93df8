"""Every number that is a choice, with its reason. Nothing here can weaken a proof."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectrumSettings:
    """Working precision of the eigenbasis, in bits."""

    start_bits: int = 192  # two sweeps from doubles; a second pass for relative gaps below 2^-32
    pose_bits: int = 96  # proved angle about 2^-94 where the gap is of the order of the spectrum
    guard_bits: int = 32  # more than the rounding of all the rotations of a run
    max_bits: int = 12288  # 3,700 digits: the checker takes integers of up to 4,300


@dataclass(frozen=True, slots=True, kw_only=True)
class AgreementSettings:
    """When a floating-point road contradicts the certificate.

    Losses are relative to the alignment between the best and the worst rotation.
    """

    closed_form_loss: float = 1e-11  # a thousand times the rounding of an O(N) sum
    relaxation_loss: float = 1e-5  # a thousand times the solver's tolerance
    simulation_loss: float = 1e-2  # a run stops at |s'| < 1e-4, near the optimum, not at it
    energy_ulps: float = 64.0  # of rounding in a logged energy: a sum of twelve products


@dataclass(frozen=True, slots=True, kw_only=True)
class RelaxationSettings:
    """How far the semidefinite solver goes. Data are scaled so that the largest entry is near 1."""

    gap_tolerance: float = 1e-8  # Clarabel's own default
    feasibility_tolerance: float = 1e-8  # as above
    max_iterations: int = 100  # seven are usual
    rank_threshold: float = 1e-4  # of the largest eigenvalue of Z


@dataclass(frozen=True, slots=True, kw_only=True)
class MultiplierSettings:
    """How a proposed multiplier is rounded outwards. Steps are relative to the size of K."""

    bound_bits: int = 40  # mantissa of nu: a short number, at most 2^-39 of it wasted
    first_step_bits: int = 36  # 2^-36 = 1.5e-11, below what a solver promises
    growth_bits: int = 2  # each step four times the last: at most four times too far
    attempts: int = 16  # up to 2^-6: whatever is still refused was no solution


@dataclass(frozen=True, slots=True, kw_only=True)
class EliminationSettings:
    """How the quadratics are eliminated."""

    charts: int = 13  # four lines lie in at most 4 * 3 = 12 hyperplanes (1, t, t^2, t^3)
    guard_bits: int = 32  # more than products of four matrices lose; more are taken where not


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackerSettings:
    """Steps of the path tracker in t, from 1 to 0; changes of a point are relative to its size.

    Long steps may leave a path for another; whoever needs every root compares the ends.
    """

    first_step: float = 0.2  # a start system is chosen well conditioned; halved where it fails
    predictor_bound: float = 0.2  # of Newton's first change: beyond, it may leave its basin
    predictor_aim: float = 0.05  # what the next step is chosen for
    corrector_bound: float = 0.01  # of its last change, whose square is what is left: 1e-4
    step_power: float = 0.25  # the error of a cubic grows with the fourth power of the step
    least_growth: float = 0.5  # an accepted step was not that bad
    most_growth: float = 3.0  # a step is not to outrun what is known of the path
    shrink: float = 0.4  # after a step that failed
    least_step: float = 1e-4  # of t: below, something is in the way
    endgame: float = 1e-14  # t below counts as 0: less than the rounding of the coefficients
    max_rounds: int = 300  # fifteen are usual, sixty at a singular end
    care: float = 0.25  # factor of all bounds of a step when a lost path is tried again
    infinity: float = 1e6  # in a random chart a root is as large once in 10^12
    straightenings: int = 2  # quadratic convergence from 1e-4
    polishings: int = 30  # two are usual; at a double root each halves the error, to 2^-27
    polished: float = 1e-10  # of Newton's change: squared, nothing is left
    largest_move: float = 0.5  # of one polishing step: beyond, it leads to another root
    weak_share: float = 1e-2  # of a Jacobian's largest singular value: a corrector's own accuracy
    singular_condition: float = 1e11  # beyond, fewer than five digits of a root are right
    singular_residual: float = 1e-7  # relative; a double root is right to the root of an ulp
    steadiness: float = 0.5  # of a singular value: less of it may change within the error
    rounding: float = 100.0  # of Newton's last change, in ulps times the condition

    def careful(self) -> TrackerSettings:
        """The same with shorter steps that are corrected further."""
        return replace(
            self,
            first_step=self.first_step * self.care,
            predictor_bound=self.predictor_bound * self.care,
            predictor_aim=self.predictor_aim * self.care,
            corrector_bound=self.corrector_bound * self.care,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class HomotopySettings:
    """The four paths of the equilibria, and what makes their ends a complete list."""

    seed: int = 20260  # any: with another the paths differ, and the ends do not
    attempts: int = 4  # gammas; one is enough for 999 problems of 1000
    least_turn: float = 0.3  # radians, of gamma: away from 0, where real paths would meet
    most_turn: float = 1.5  # and short of pi, where start and target would cancel out
    chart_mixing: float = 0.3  # of random numbers to the axis in a path's chart
    same_root: float = 1e-3  # radians between quaternions: regular ends are right to 1e-5
    same_value: float = 1e-9  # of the size of K: singular ends are right to the root of an ulp


@dataclass(frozen=True, slots=True, kw_only=True)
class CountSettings:
    """Where a proof of the count is looked for."""

    charts: int = 13  # as in `EliminationSettings`
    primes: tuple[int, ...] = (2**61 - 1,)  # divides a determinant by accident once in 10^18


@dataclass(frozen=True, slots=True, kw_only=True)
class KrawczykSettings:
    """Working precision of the proofs of roots, in bits."""

    start_bits: int = 128  # costs as much as 64, and the boxes are as small as 1e-30
    max_bits: int = 2048  # for relative gaps down to 1e-300
    refinements: int = 12  # Newton steps at one precision: 2^-4 to 2^-2048 takes nine
    inflation: int = 4  # of Newton's step to the box: what is left is quadratic in the step


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadSettings:
    """When two roads to the equilibria disagree."""

    first_bits: int = 64  # tells the pattern; more are taken where values are close
    angle: float = 1e-10  # radians; the bases of decided roads hold 28 digits and more
    level: float = 1e-12  # of the range of critical values


@dataclass(frozen=True, slots=True, kw_only=True)
class CoqSettings:
    """How long Coq may think, and how a certificate is cut up for it."""

    seconds: float = 600.0  # 338 points take four; hostile exponents could take days
    points_in_a_list: int = 500  # 10^5 overflow the stack of its parser
