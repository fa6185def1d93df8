"""certreg: certified registration of corresponding 3D point clouds.

Every pose comes with all equilibria of the registration dynamics and with a certificate of global
optimality that a one-file checker accepts or refuses in exact arithmetic.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from certreg.certificate.checking import verify as verify
    from certreg.certificate.envelope import Certificate as Certificate
    from certreg.dynamics.simulation import Trajectory as Trajectory
    from certreg.errors import CertregError as CertregError
    from certreg.geometry.pose import Pose as Pose
    from certreg.problem.problem import RegistrationProblem as RegistrationProblem
    from certreg.registration.alignment import register as register
    from certreg.registration.assessment import Assessment as Assessment
    from certreg.registration.assessment import assess as assess
    from certreg.registration.certification import Registration as Registration
    from certreg.registration.certification import certify as certify
    from certreg.registration.certification import simulate as simulate
    from certreg.registration.enumeration import equilibria as equilibria
    from certreg.results import Verdict as Verdict

__version__ = "0.1.0"

_HOMES = {
    "Assessment": "certreg.registration.assessment",
    "assess": "certreg.registration.assessment",
    "Certificate": "certreg.certificate.envelope",
    "CertregError": "certreg.errors",
    "Pose": "certreg.geometry.pose",
    "Registration": "certreg.registration.certification",
    "RegistrationProblem": "certreg.problem.problem",
    "Trajectory": "certreg.dynamics.simulation",
    "Verdict": "certreg.results",
    "certify": "certreg.registration.certification",
    "equilibria": "certreg.registration.enumeration",
    "register": "certreg.registration.alignment",
    "simulate": "certreg.registration.certification",
    "verify": "certreg.certificate.checking",
}

__all__ = [
    "Assessment",
    "Certificate",
    "CertregError",
    "Pose",
    "Registration",
    "RegistrationProblem",
    "Trajectory",
    "Verdict",
    "__version__",
    "assess",
    "certify",
    "equilibria",
    "register",
    "simulate",
    "verify",
]


class _Face(ModuleType):
    """The public face: names are imported when first used, so that `import certreg` stays light.

    `verify` and `equilibria` are functions here and also submodules. The import system stores a
    submodule on its package under its own name; the functions must win.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOMES and isinstance(value, ModuleType)):
            super().__setattr__(name, value)

    def __getattr__(self, name: str) -> Any:
        home = _HOMES.get(name)
        if home is None:
            message = f"module 'certreg' has no attribute {name!r}"
            raise AttributeError(message)
        value = getattr(import_module(home), name)
        setattr(self, name, value)
        return value

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *_HOMES})


sys.modules[__name__].__class__ = _Face
