"""The derivations: a chain of claims from the Lagrangian to the code that is shipped.

`kernel` says what a claim and a control are, and proves; `steps` what a step is, `hypothesis` what
it may use, `algebra` holds the exact checks, on the polynomials of `rings`; `instances` looks for
the points at which what must be false is. `notation`, `moments` and `motion` hold the symbols,
`hypotheses` those that several claims share. Each file in `claims` states one theorem
and proves it about the shipped function; `book` puts them in the order in which one needs another;
`audit` holds the paper's claims against them; `emit` turns derived expressions into code.

Run by `certreg derive`, by the tests, and by the pages of the documentation.
"""

from __future__ import annotations

import os

# SymPy reads this when it is first imported. It keeps 1000 results of each function where it is not
# set; claims come back to the same expressions: with 20,000 all proofs take a quarter less time.
os.environ.setdefault("SYMPY_CACHE_SIZE", "20000")
