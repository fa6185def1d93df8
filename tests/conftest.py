"""Fixed seeds for every property test: a failure is the same failure everywhere."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "certreg",
    derandomize=True,
    deadline=None,  # the machines are shared: no property is about time
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.load_profile("certreg")

DATA = Path(__file__).parent.parent / "certreg" / "data"


@pytest.fixture
def data() -> Path:
    return DATA
