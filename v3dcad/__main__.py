"""`python -m v3dcad`: the command line, for those who know an interpreter and no script."""

from v3dcad.cli import main

main()
