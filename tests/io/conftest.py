"""In every test of a reader each refusal names its file, and holds evidence of the right kind."""

from __future__ import annotations

from typing import Any

import pytest
from refusals import wrong_evidence

from certreg.errors import InvalidFileError

HELD = InvalidFileError.__init__


@pytest.fixture(autouse=True)
def evidence_is_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    def checked(self: InvalidFileError, message: str, **evidence: Any) -> None:
        wrong = wrong_evidence(message, evidence)
        assert wrong is None, f"{message}: {wrong}"
        HELD(self, message, **evidence)

    monkeypatch.setattr(InvalidFileError, "__init__", checked)
