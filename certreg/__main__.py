"""`python -m certreg`."""

from certreg.cli.main import main

main()
