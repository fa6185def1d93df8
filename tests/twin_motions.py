"""An instance of springs that break with two stable equilibria, in whole numbers.

Four points stay where they are, three are shifted, each by its own motion without an error. So the
body hangs on the first four, with the energy 3 of the three broken springs, or on the last three,
with the energy 4. Claim: `springs_that_break`.
"""

SOURCE = (
    *((0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)),
    *((20, 0, 0), (20, 3, 0), (20, 0, 3)),
)
TARGET = (
    *((0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)),
    *((24, 0, 0), (24, 3, 0), (24, 0, 3)),
)
STABLE = [((0, 1, 2, 3), 3.0), ((4, 5, 6), 4.0)]  # the springs that hold, and the energy
