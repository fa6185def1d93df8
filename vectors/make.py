"""Makes the test vectors for checkers of `certreg-certificate/1`: integers only, the same anywhere.

    python vectors/make.py [FOLDER]

Each file is a certificate that a checker must accept or refuse; `manifest.json` says which, and
why. `theorems.txt` holds what the reference checker says of the accepted ones: so a sentence that
changes is seen. Nothing here depends on floating-point libraries: eigenvectors come from integer
iteration. Certificates in KEPT are not made but kept, as they were found.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

import cones
import consensus
import count
import isotropic
import lists
import scaled
import similarity
import sprung
import squares
import still
import truncated
from envelope import dumped

from certreg.verify import check

KEPT = ("accept-consensus-springs-reach-of-the-pose.json",)  # whose fit is far from the optimum


def vectors() -> dict[str, tuple[bytes, str]]:
    """Content and class by file name; the class of an accepted one is empty."""
    kinds = (isotropic, count, squares, cones, lists, similarity, truncated, consensus, sprung)
    kinds = (*kinds, scaled, still)
    made = {
        name: (dumped(certificate), reason)
        for kind in kinds
        for name, (certificate, reason) in kind.vectors().items()
    }
    once, twice = b'"kind": "isotropic"', b'"kind": "isotropic", "kind": "isotropic"'
    good, _ = made["accept-pattern-1111.json"]
    kept = {name: ((Path(__file__).parent / name).read_bytes(), "") for name in KEPT}
    return {**made, **kept, "refuse-key-twice.json": (good.replace(once, twice), "form")}


def manifest(found: dict[str, tuple[bytes, str]]) -> bytes:
    """What a checker must say of each file."""
    entries = [
        {
            "file": name,
            "reason": reason or None,
            "sha256": hashlib.sha256(content).hexdigest(),
            "verdict": "REFUSED" if reason else "VERIFIED",
        }
        for name, (content, reason) in sorted(found.items())
    ]
    return (json.dumps({"schema": "certreg-vectors/1", "vectors": entries}, indent=1)).encode()


def theorems(found: dict[str, tuple[bytes, str]]) -> str:
    """What the reference checker says of each file that it accepts."""
    accepted = {name: check(content) for name, (content, reason) in found.items() if not reason}
    parts = [[name, *accepted[name].theorems] for name in sorted(accepted)]
    return "\n\n".join("\n  ".join(part) for part in parts)


def write(folder: Path) -> None:
    """All files, into a folder."""
    found = vectors()
    for name, (content, _) in found.items():
        (folder / name).write_bytes(content)
    (folder / "manifest.json").write_bytes(manifest(found) + b"\n")
    (folder / "theorems.txt").write_bytes(f"{theorems(found)}\n".encode())


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
