"""`python -m v3dcad.worker FOLDER`."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path


def preparing() -> Iterator[str]:
    """Load what later requests need, step by step. What cannot be loaded, they say themselves."""
    from v3dcad.warm_up import ALL, warm_up

    try:
        for name in ("v3dcad.pipeline", "v3dcad.kernel.load", *ALL):
            warm_up([name])
            yield name
    except Exception:  # such as a missing kernel: no reason to end
        traceback.print_exc(file=sys.stderr)


def main() -> None:
    """Answer requests from standard input on standard output, until the input ends."""
    from v3dcad.worker.parent import requests_of

    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_dir():
        sys.exit("v3dcad.worker: give one folder, for the files that answers name")
    requests = requests_of(os.fdopen(os.dup(0), "rb"), preparing())
    # Whatever a library prints, in Python or C++, must not come between two answers.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    from v3dcad.worker.loop import serve  # which loads the engine

    serve(requests, answers, Path(sys.argv[1]))


if __name__ == "__main__":
    main()
