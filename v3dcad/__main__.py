"""`python -m v3dcad` is `v3dcad`, for programs that know only where their Python is."""

from v3dcad.cli import main

main()
