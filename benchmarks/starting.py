"""How long a fill takes to start: `python -m benchmarks.starting`.

Fills the sample bracket as README does, with an empty cache of compiled code and then with a full
one, and says what the imports of the second fill cost, by library (`python -X importtime`). Seconds
by the clock, and of the processor (with those of the second process that helps to compile).
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
LIBRARIES = ("OCP", "numba", "llvmlite", "scipy", "numpy", "matplotlib", "shapely", "v3dcad")


def fill(folder: Path, *options: str) -> tuple[float, float, str]:
    """Fill the bracket; seconds by the clock, of the processor, and what stderr got."""
    words = ["-m", "v3dcad", "fill", "samples/bracket.step", "--out", str(folder / "out")]
    begun, before = time.perf_counter(), os.times()
    done = subprocess.run(
        [sys.executable, *options, *words],
        cwd=ROOT,
        env={**os.environ, "NUMBA_CACHE_DIR": str(folder / "cache")},
        check=True,
        capture_output=True,
        encoding="utf-8",
    )
    after = os.times()
    return time.perf_counter() - begun, sum(after[2:4]) - sum(before[2:4]), done.stderr


def import_times(said: str) -> Counter[str]:
    """Seconds that a library's own modules took to import, from what `-X importtime` says."""
    seconds: Counter[str] = Counter()
    for own, name in re.findall(r"import time: +([0-9]+) \|[ 0-9]+\| +(\S+)", said):
        library = name.split(".")[0]
        seconds[library if library in LIBRARIES else "others"] += int(own) * 1e-6
    return seconds


def main() -> None:
    """Print both tables."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        first = fill(folder)
        second = min(fill(folder) for _ in range(3))
        imports = import_times(fill(folder, "-X", "importtime")[2])
    print("| fill of the bracket | s | processor, s |\n|---|---|---|")
    for what, (clock, used, _) in (("first", first), ("second", second)):
        print(f"| {what} | {clock:.1f} | {used:.1f} |")
    print("\n| imports of the second | s |\n|---|---|")
    for library, spent in imports.most_common():
        print(f"| {library} | {spent:.2f} |")
    print(f"| all | {imports.total():.2f} |")


if __name__ == "__main__":
    main()
