"""Whether memory that is freed is kept, by the page faults that the system counts."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

CODE = """
import resource
import numpy as np
from v3dcad.structure.memory import keep_freed_memory

def faults():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    arrays = [np.ones(2 << 20, np.uint8) for _ in range(8)]
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

KEEP
faults()
print(faults())
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="only glibc hands memory back so")
def test_arrays_made_again_fault_in_no_pages() -> None:
    """16 MiB in eight arrays, written, freed and made again; each in a process of its own."""
    kept, lost = (
        int(subprocess.check_output([sys.executable, "-c", CODE.replace("KEEP", line)]))
        for line in ("keep_freed_memory()", "")
    )
    assert kept < lost / 10
