"""Programs that import a module of their own, with a cache of compiled code that begins empty."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest


@pytest.fixture
def said_twice(tmp_path: Path) -> Callable[[str, str], list[str]]:
    """What a program says, run twice: `halves.py` has a source, and the second run has a cache."""

    def said(source: str, show: str) -> list[str]:
        (tmp_path / "halves.py").write_text(source)
        return [
            subprocess.run(
                [sys.executable, "-c", show], capture_output=True, encoding="utf-8", check=True,
                cwd=tmp_path,
                env={
                    **os.environ,
                    "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path]),
                    "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
                },
            ).stdout
            for _ in range(2)
        ]  # fmt: skip

    return said
