"""certreg: certified registration of corresponding 3D point clouds.

Every pose comes with all equilibria of the registration dynamics and with a certificate of global
optimality that a one-file checker accepts or refuses in exact arithmetic.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from certreg import results as _results
from certreg._loading import found_late, lazy_face
from certreg.certificate.checking import verify as verify

if TYPE_CHECKING:
    from certreg.certificate.envelope import Certificate as Certificate
    from certreg.certificate.many import Certificates as Certificates
    from certreg.dynamics.batch import bodies_of as bodies_of
    from certreg.dynamics.batch import bodies_on_springs as bodies_on_springs
    from certreg.dynamics.batch import simulate_many as simulate_many
    from certreg.dynamics.integrators import SimulationSettings as SimulationSettings
    from certreg.dynamics.trajectory import Trajectory as Trajectory
    from certreg.equilibrium.batch import solve_many as solve_many
    from certreg.equilibrium.line_batch import solve_many_springs as solve_many_springs
    from certreg.errors import CertregError as CertregError
    from certreg.geometry.pose import Pose as Pose
    from certreg.geometry.similarity import Similarity as Similarity
    from certreg.io.clouds import read_cloud as read_cloud
    from certreg.io.objects import load as load
    from certreg.io.objects import pair as pair
    from certreg.io.problems import read_problem as read_problem
    from certreg.problem.gicp import gicp_information as gicp_information
    from certreg.problem.problem import RegistrationProblem as RegistrationProblem
    from certreg.registration.assessed import Assessment as Assessment
    from certreg.registration.assessment import assess as assess
    from certreg.registration.breaking import breaking_equilibria as breaking_equilibria
    from certreg.registration.breaking import simulate_breaking as simulate_breaking
    from certreg.registration.certification import certify as certify
    from certreg.registration.closed_form import register as register
    from certreg.registration.enumeration import equilibria as equilibria
    from certreg.registration.landscape import AssessmentSettings as AssessmentSettings
    from certreg.registration.many import certify_many as certify_many
    from certreg.registration.result import Registration as Registration
    from certreg.registration.simulation import simulate as simulate
    from certreg.results import Verdict as Verdict


# Not lazily: this loads the module `certreg.verify`, too, which Python binds to that name when it
# is first loaded, and never again. So the function, bound after it, stays.


__version__ = "0.1.0"

__all__ = [
    "Assessment",
    "AssessmentSettings",
    "Certificate",
    "Certificates",
    "CertregError",
    "Pose",
    "Registration",
    "RegistrationProblem",
    "Similarity",
    "SimulationSettings",
    "Trajectory",
    "Verdict",
    "__version__",
    "assess",
    "bodies_of",
    "bodies_on_springs",
    "breaking_equilibria",
    "certify",
    "certify_many",
    "equilibria",
    "gicp_information",
    "load",
    "pair",
    "read_cloud",
    "read_problem",
    "register",
    "simulate",
    "simulate_breaking",
    "simulate_many",
    "solve_many",
    "solve_many_springs",
    "verify",
]

__getattr__ = lazy_face(
    __name__,
    {
        "certificate.envelope": ("Certificate",),
        "certificate.many": ("Certificates",),
        "dynamics.batch": (
            "bodies_of",
            "bodies_on_springs",
            "simulate_many",
        ),
        "dynamics.integrators": ("SimulationSettings",),
        "dynamics.trajectory": ("Trajectory",),
        "equilibrium.batch": ("solve_many",),
        "equilibrium.line_batch": ("solve_many_springs",),
        "errors": ("CertregError",),
        "geometry.pose": ("Pose",),
        "geometry.similarity": ("Similarity",),
        "io.clouds": ("read_cloud",),
        "io.objects": (
            "load",
            "pair",
        ),
        "io.problems": ("read_problem",),
        "problem.gicp": ("gicp_information",),
        "problem.problem": ("RegistrationProblem",),
        "registration.assessed": ("Assessment",),
        "registration.assessment": ("assess",),
        "registration.breaking": (
            "breaking_equilibria",
            "simulate_breaking",
        ),
        "registration.certification": ("certify",),
        "registration.closed_form": ("register",),
        "registration.enumeration": ("equilibria",),
        "registration.landscape": ("AssessmentSettings",),
        "registration.many": ("certify_many",),
        "registration.result": ("Registration",),
        "registration.simulation": ("simulate",),
        "results": ("Verdict",),
    },
)


def __dir__() -> list[str]:
    return __all__


# Whoever wants to hear what was chosen (compiled C, the damping, the pairs) listens to `certreg`.
logging.getLogger(__name__).addHandler(logging.NullHandler())

# Results are shown by a wing below those that make them: it is named here, above all of them.
_results.present_by(found_late("certreg.report.presenting", "PRESENTER"))
