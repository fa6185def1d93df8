"""The hook by which hatchling has the C code compiled, for a wheel or an editable install."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

BUILT = "certreg/native/built"


class KernelsHook(BuildHookInterface[Any]):
    """Runs build_kernels.py in a process of its own, whose path begins with this folder.

    A wheel that carries libraries is for this platform and any Python: ctypes loads them.
    """

    def dependencies(self) -> list[str]:
        """Pip, which fetches a compiler where there is none; the requirement itself cannot fail."""
        return ["pip"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile into the checkout if it is to be editable, else into a folder for the wheel."""
        script = Path(self.root) / "build_kernels.py"
        if version == "editable":
            self._run(str(script))
            return
        self._folder = tempfile.TemporaryDirectory(prefix="certreg-wheel-")
        self._run(str(script), self._folder.name)
        build_data["force_include"][self._folder.name] = BUILT
        if any(Path(self._folder.name).glob("kernels-*")):
            build_data["pure_python"] = False
            platform = self.build_config.builder.get_best_matching_tag().rpartition("-")[2]
            build_data["tag"] = f"py3-none-{platform}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove that folder."""
        del build_data, artifact_path
        if version != "editable":
            self._folder.cleanup()

    def _run(self, *command: str) -> None:
        try:
            subprocess.run([sys.executable, *command], check=True)  # noqa: S603 - our own script
        except subprocess.CalledProcessError as error:
            raise SystemExit(error.returncode) from error
