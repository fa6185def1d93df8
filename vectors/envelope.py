"""What all certificates have: the data, their digest, and how they are written."""

from __future__ import annotations

import base64
import hashlib
import json
from typing import Any

Points = list[list[float]]
Certificate = dict[str, Any]
Vectors = dict[str, tuple[Certificate, str]]  # with the class of reason, empty where accepted
ABOUT = {"made by": "vectors/make.py"}
FORMAT = "certreg-certificate/1"


def stated(content: bytes, n: int) -> dict[str, Any]:
    """The `problem` of a certificate."""
    text = base64.b64encode(content).decode()
    return {"data": text, "digest": hashlib.sha256(content).hexdigest(), "n": n}


def of_another_digest(good: Certificate) -> Certificate:
    """Which the data do not have."""
    return good | {"problem": good["problem"] | {"digest": "0" * 64}}


def lower(pair: list[int]) -> list[int]:
    """A bound by one unit less."""
    return [pair[0] - 1, pair[1]]


def dumped(certificate: Certificate) -> bytes:
    """The file's content."""
    return json.dumps(certificate, sort_keys=True).encode() + b"\n"
