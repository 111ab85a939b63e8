"""Compiled code frees all arrays that it makes, although most of it counts no references."""

import subprocess
import sys

import pytest

pytestmark = pytest.mark.slow

COUNT = """
import gc
from numba.core.runtime import _nrt_python, rtsys

_nrt_python.memsys_enable_stats()
from v3dcad.warm_up import warm_up

warm_up()
gc.collect()
count = rtsys.get_allocation_stats()
print(count.alloc, count.free, count.mi_alloc, count.mi_free)
"""


def test_what_is_allocated_is_freed() -> None:
    """In everything that is compiled: a reference too many keeps an array, one too few crashes."""
    found = subprocess.run(
        [sys.executable, "-c", COUNT], capture_output=True, text=True, check=True
    )
    allocated, freed, arrays, arrays_freed = map(int, found.stdout.split())
    assert allocated > 1000
    assert (freed, arrays_freed) == (allocated, arrays)
