"""Instructions of x86-64 that not every such processor has, found in a library by objdump.

    python tests/instructions.py LIBRARY ...

prints those above the baseline, each once, and ends with 1 where there is one.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

# No other instruction that a library may hold begins with v, and none but those of masks with k.
AVX = r"v\w+|k(?:add|andn?|mov|not|or(?:test)?|shift[lr]|test|unpck|xn?or)\w*"
SSE3 = r"addsubp[sd]|fisttp\w*|h(?:add|sub)p[sd]|lddqu|mov(?:d|sh|sl)dup"
SSSE3 = r"pabs[bwd]|palignr|ph(?:add|sub)\w+|pmaddubsw|pmulhrsw|pshufb|psign[bwd]"
SSE4 = (
    r"p?blend\w+|crc32\w*|dpp[sd]|extractps|insertps|movntdqa|mpsadbw|packusdw|pcmp(?:eq|gt)q"
    r"|pcmp[ei]str[im]|pextr[bdq]|phminposuw|pinsr[bdq]|p(?:max|min)(?:s[bd]|u[dw])|pmov[sz]x\w+"
    r"|pmuldq|pmulld|ptest|round[ps][sd]"
)
# Not tzcnt: where a processor does not know it, it runs as bsf, and compilers write it for that.
BITS = (
    r"(?:ad[co]x|andn|bextr|bls(?:i|r|msk)|bzhi|lzcnt|movbe|mulx|pdep|pext|popcnt|rorx"
    r"|s(?:ar|hl|hr)x)[lqw]?"
)
OTHERS = r"cmpxchg16b|aes\w+|pclmul\w+|sha(?:1|256)\w+|rd(?:rand|seed)"
ABOVE = re.compile(
    rf"\t(?:[\w{{}}]+ )*({AVX}|{SSE3}|{SSSE3}|{SSE4}|{BITS}|{OTHERS})(?: |$)", re.MULTILINE
)


def above_the_baseline(listing: str) -> list[str]:
    """The instructions of objdump's lines that a processor of the first level may lack."""
    return sorted(set(ABOVE.findall(listing)))


def fused(listing: str) -> list[str]:
    """The instructions that round once where a product and a sum round twice."""
    return sorted(set(re.findall(r"\tv?(fn?m(?:add|sub)\w*)", listing)))


def taken_from_the_system(library: Path) -> set[str]:
    """The functions that a library does not hold itself."""
    command = ["objdump", "--dynamic-syms", str(library)]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=True)
    undefined = (line.split() for line in done.stdout.splitlines() if "*UND*" in line)
    return {words[-1] for words in undefined if "w" not in words[1:3]}


def listing_of(library: Path) -> str:
    """What objdump prints of a library; raises where it holds no code."""
    command = ["objdump", "--disassemble", "--no-show-raw-insn", str(library)]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=True)
    if "ret" not in done.stdout:
        raise ValueError(f"{library}: objdump finds no code")
    return done.stdout


def main() -> int:
    """Print what each library holds that is above the baseline."""
    wrong = 0
    for name in sys.argv[1:]:
        found = above_the_baseline(listing_of(Path(name)))
        sys.stdout.write(f"{name}: {' '.join(found) or 'nothing above the baseline'}\n")
        wrong += bool(found)
    return 1 if wrong or not sys.argv[1:] else 0


if __name__ == "__main__":
    sys.exit(main())
