"""Clouds larger than the memory that certifying them may take; ARGS: gigabytes.

Two clouds of so many gigabytes each are written to temporary files, 8 by default or what the disk
allows, mapped, and registered and certified in a process of its own, whose memory is limited.

Limited is what a process has for itself (RLIMIT_DATA). The pages of a mapped file that it has read
are not: they are the system's, which takes them back when memory is scarce.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
LIMIT = 200  # megabytes beyond what starting and a tiny problem take
ASKED, ENOUGH = 8.0, 1.0  # gigabytes a cloud
BLOCK = 1 << 18
CHILD = """
import json, resource, sys
import numpy as np
import certreg
certreg.certify(certreg.RegistrationProblem(np.eye(3), np.eye(3)))
lines = open("/proc/self/status").read().splitlines()
before = next(int(line.split()[1]) for line in lines if line.startswith("VmData")) << 10
resource.setrlimit(resource.RLIMIT_DATA, (before + (int(sys.argv[4]) << 20),) * 2)
clouds = (np.load(name, mmap_mode="r") for name in sys.argv[1:3])
registration = certreg.certify(certreg.RegistrationProblem(*clouds))
registration.certificate.save(sys.argv[3])
print(json.dumps({
    "n": registration.problem.n,
    "status": registration.status.name,
    "rotation": registration.pose.rotation.tolist(),
    "timings": registration.timings,
}))
"""


@dataclass(frozen=True)
class Run:
    """What a process said of its registration: seconds, and the rotation."""

    n: int
    status: str
    rotation: np.ndarray
    timings: dict[str, float]

    @classmethod
    def of(cls, source: Path, target: Path, certificate: Path, megabytes: int) -> Run:
        """Certify two mapped clouds in a process of its own, which gets so much more memory.

        Raises CalledProcessError where that is not enough.
        """
        arguments = (source, target, certificate, megabytes)
        command = [sys.executable, "-c", CHILD, *map(str, arguments)]
        done = subprocess.run(
            command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True, encoding="utf-8"
        )
        said = json.loads(done.stdout)
        return cls(**said | {"rotation": np.array(said["rotation"])})


def turn() -> np.ndarray:
    """The rotation between the clouds: a third of a turn about (1, 1, 1), then 60 degrees."""
    cosine, sine = 0.5, np.sqrt(0.75)
    about_z = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return about_z[:, [2, 0, 1]]


def write_clouds(folder: Path, n: int) -> tuple[Path, Path]:
    """Two npy files of n points, written block by block; noise of a hundredth on the second.

    Random numbers would take longer than the disk: each block is the first one, moved elsewhere.
    """
    rng = np.random.default_rng(12)
    cloud = rng.normal(size=(BLOCK, 3)) * (3.0, 2.0, 1.0)
    moved = cloud @ turn().T + (5.0, -7.0, 11.0) + 0.01 * rng.normal(size=cloud.shape)
    places = rng.normal(size=(-(-n // BLOCK), 3))
    files = folder / "source.npy", folder / "target.npy"
    header = {"descr": "<f8", "fortran_order": False, "shape": (n, 3)}
    with files[0].open("wb") as source, files[1].open("wb") as target:
        for stream in (source, target):
            np.lib.format.write_array_header_1_0(stream, header)
        for k, place in enumerate(places):
            source.write((cloud + place)[: n - k * BLOCK].data)
            target.write((moved + turn() @ place)[: n - k * BLOCK].data)
    return files


def size(free: float, asked: float) -> float:
    """Gigabytes a cloud: as asked for, or what fits twice into three quarters of the free space."""
    return min(asked, 0.375 * free)


def main(asked: float) -> int:
    """Exit code 0 if the limits are kept, 1 if not, 2 if the disk is too small."""
    with tempfile.TemporaryDirectory(prefix="certreg-huge-") as name:
        folder = Path(name)
        gigabytes = size(shutil.disk_usage(folder).free / 1e9, asked)
        if gigabytes < ENOUGH:
            sys.stderr.write(f"{folder} has no room for {ENOUGH:g} GB twice: set TMPDIR\n")
            return 2
        start = time.perf_counter()
        files = write_clouds(folder, int(gigabytes * 1e9 / 24))
        _say(f"two clouds of {gigabytes:.3g} GB written, {time.perf_counter() - start:.0f} s")
        start = time.perf_counter()
        try:
            run = Run.of(*files, folder / "certificate.json", LIMIT)
        except subprocess.CalledProcessError:
            _say(f"MISSED: not done within {LIMIT} MB")
            return 1
        _say(f"{run.n} points, {time.perf_counter() - start:.0f} s, {run.status}, {run.timings}")
        error = float(np.abs(run.rotation - turn()).max())
        _say(f"done within {LIMIT} MB; rotation off {error:.1e}")
        kept = run.status == "CERTIFIED" and error < 1e-4  # 0.01 over 2^9
        _say("all limits kept" if kept else "MISSED")
    return 0 if kept else 1


def _say(words: str) -> None:
    sys.stdout.write(words + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else ASKED))
