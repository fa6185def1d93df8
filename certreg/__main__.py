"""`python -m certreg`."""

from certreg.cli import main

main()
