"""Lists the large samples: `make rates`."""

from __future__ import annotations

import ast
import sys
from pathlib import Path


def main() -> int:
    """Print each module with the first line of what it says of itself."""
    for path in sorted(Path(__file__).parent.glob("[a-z]*.py")):
        words = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
        print(f"{path.stem:22}{words.partition(chr(10))[0]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
