"""certreg: certified registration of corresponding 3D point clouds.

Every pose comes with all equilibria of the registration dynamics and with a certificate of global
optimality that a one-file checker accepts or refuses in exact arithmetic.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from certreg import results as _results
from certreg._loading import found_late, lazy_face

# Not lazily: this loads the module `certreg.verify`, too, which Python binds to that name when it
# is first loaded, and never again. So the function, bound after it, stays.
from certreg.certificate import verify as verify

if TYPE_CHECKING:
    from certreg.certificate import Certificate as Certificate
    from certreg.certificate import Certificates as Certificates
    from certreg.dynamics import SimulationSettings as SimulationSettings
    from certreg.dynamics import Trajectory as Trajectory
    from certreg.dynamics import bodies_of as bodies_of
    from certreg.dynamics import bodies_on_springs as bodies_on_springs
    from certreg.dynamics import simulate_many as simulate_many
    from certreg.equilibrium import solve_many as solve_many
    from certreg.equilibrium import solve_many_springs as solve_many_springs
    from certreg.errors import CertregError as CertregError
    from certreg.geometry import Pose as Pose
    from certreg.geometry import Similarity as Similarity
    from certreg.io import load as load
    from certreg.io import pair as pair
    from certreg.io import read_cloud as read_cloud
    from certreg.io import read_problem as read_problem
    from certreg.problem import RegistrationProblem as RegistrationProblem
    from certreg.problem import gicp_information as gicp_information
    from certreg.registration import Assessment as Assessment
    from certreg.registration import AssessmentSettings as AssessmentSettings
    from certreg.registration import Registration as Registration
    from certreg.registration import assess as assess
    from certreg.registration import breaking_equilibria as breaking_equilibria
    from certreg.registration import certify as certify
    from certreg.registration import certify_many as certify_many
    from certreg.registration import equilibria as equilibria
    from certreg.registration import register as register
    from certreg.registration import simulate as simulate
    from certreg.registration import simulate_breaking as simulate_breaking
    from certreg.results import Verdict as Verdict

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
        "certificate": (
            "Certificate",
            "Certificates",
        ),
        "dynamics": (
            "SimulationSettings",
            "Trajectory",
            "bodies_of",
            "bodies_on_springs",
            "simulate_many",
        ),
        "equilibrium": (
            "solve_many",
            "solve_many_springs",
        ),
        "errors": ("CertregError",),
        "geometry": (
            "Pose",
            "Similarity",
        ),
        "io": (
            "load",
            "pair",
            "read_cloud",
            "read_problem",
        ),
        "problem": (
            "RegistrationProblem",
            "gicp_information",
        ),
        "registration": (
            "Assessment",
            "AssessmentSettings",
            "Registration",
            "assess",
            "breaking_equilibria",
            "certify",
            "certify_many",
            "equilibria",
            "register",
            "simulate",
            "simulate_breaking",
        ),
        "results": ("Verdict",),
    },
)


def __dir__() -> list[str]:
    return __all__


# Whoever wants to hear what was chosen (compiled C, the damping, the pairs) listens to `certreg`.
logging.getLogger(__name__).addHandler(logging.NullHandler())

# Results are shown by a wing below those that make them: it is named here, above all of them.
_results.present_by(found_late("certreg.report", "PRESENTER"))
