"""Results as plain sentences and a small table: what a person reads in a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import late
from certreg.report.lines import (
    away_words,
    equilibria_summary,
    explained_words,
    margin_words,
    method_lines,
    number,
    rate_words,
    status_lines,
    step_words,
    uncertainty_lines,
    unit_words,
    untested_lines,
    warnings,
)
from certreg.report.remedies import ADVICE, remedies, why_warned
from certreg.report.robustness import robustness_words
from certreg.report.thinning import unspent_words
from certreg.results import (
    present,
)

if TYPE_CHECKING:
    from certreg.registration.result import Registration
    from certreg.registration.simulation import SimulatedRegistration
    from certreg.report import scaled_summary
else:
    scaled_summary = late("certreg.report.scaled_summary")

OF_PRINTED = "; at rounding, of the pose as printed"  # below, of the exact optimum


def registration_summary(registration: Registration) -> str:
    """The result of `certify`, readable."""
    if registration.problem.scaled:
        return scaled_summary.scaled_summary(registration)
    return rigid_summary(registration)


def rigid_summary(registration: Registration) -> str:
    """The result of `certify` of scale 1, readable."""
    pose, status = registration.pose, status_lines(registration)
    fit = registration.fit
    exact = number(registration.equilibria.components[0].rmse)
    differs = fit.rounded and number(registration.rmse) != exact
    weighted = f"weighted, {unit_words(fit)}{OF_PRINTED if differs else ''}"
    return "\n".join(
        (
            *status,
            *(f"{ADVICE}{words}" for words in remedies(registration)),
            "",
            f"  correspondences   {registration.problem.n}",
            f"  rotation (wxyz)   {' '.join(map(repr, pose.quaternion_wxyz.tolist()))}",
            f"  translation       {' '.join(map(repr, pose.translation.tolist()))}",
            *uncertainty_lines(registration),
            f"  RMSE              {number(registration.rmse)}  ({weighted})",
            f"  explained         {explained_words(fit)}{why_warned(fit)}",
            *untested_lines(fit),
            f"  ambiguity margin  {margin_words(registration.equilibria)}",
            f"  robustness        {robustness_words(registration)}",
            *method_lines(registration),
            *(f"  warning           {words}" for words in warnings(registration, status[0])),
            "",
            equilibria_summary(registration.equilibria),
        )
    )


def simulation_summary(simulated: SimulatedRegistration) -> str:
    """The result of `simulate`, readable; energies in objective units."""
    trajectory, unspent = simulated.trajectory, unspent_words(simulated.trajectory)
    end = away_words(simulated.angle_to_optimum, unique=simulated.unique)
    initial, final = (present(energy) for energy in simulated.energies)
    proved = "Proved:" if simulated.in_certified_basin else "Not proved that"
    which = "the" if simulated.unique else "an"
    return "\n".join(
        (
            trajectory.status.value,
            f"  integrator        {trajectory.integrator.value}",
            f"  steps             {trajectory.steps}, {step_words(trajectory.step)}",
            f"  time              {trajectory.times[-1]:.6g}  (unit of the springs)",
            f"  escapes           {trajectory.escapes}  (kicked off a saddle)",
            f"  initial energy    {number(initial)}  (kinetic and potential)",
            f"  final energy      {number(final)}",
            f"  residual          {trajectory.speed:.3g}  (norm of the 18 rates of change)",
            f"  decay rate        {rate_words(trajectory)}",
            f"  end               {end if unspent is None else f'its rotation {end}'}",
            *([] if unspent is None else [f"  not there yet     {unspent}"]),
            f"{proved} from its last state the exact motion ends at {which} optimum.",
        )
    )
