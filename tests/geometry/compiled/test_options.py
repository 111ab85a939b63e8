"""Functions that only compiled code calls: compiled with their callers, and not loaded again."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

SOURCE = """
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled

@compiled(INTERNAL)
def half(number: float) -> float:
    return number / 2

@compiled(ENTRY)
def quarter(number: float) -> float:
    return half(half(number + 1) - 1 / 2)
"""
SHOW = "import halves; print(halves.quarter(6), list(halves.half.overloads))"


def test_an_inner_function_has_its_one_signature_and_is_not_loaded_where_its_caller_is_cached(
    tmp_path: Path,
) -> None:
    (tmp_path / "halves.py").write_text(SOURCE)
    said = [
        subprocess.run(
            [sys.executable, "-c", SHOW], capture_output=True, encoding="utf-8", check=True,
            cwd=tmp_path,
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path]),
                "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
            },
        ).stdout
        for _ in range(2)
    ]  # fmt: skip
    assert said == ["1.5 [(float64,)]\n", "1.5 []\n"]
