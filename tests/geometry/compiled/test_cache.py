from __future__ import annotations

from pathlib import Path

import pytest

from v3dcad.geometry.compiled.cache import forget_stale

FOLDERS = ["geometry", "geometry/clipping", "structure", "structure/sweep/deep"]


@pytest.fixture
def package(tmp_path: Path) -> Path:
    for name in FOLDERS:
        (tmp_path / name / "__pycache__").mkdir(parents=True)
        (tmp_path / name / "one.py").write_text(f"NAME = {name!r}")
    return tmp_path


def compile_all(package: Path) -> list[Path]:
    """What numba leaves behind, in every folder."""
    caches = [package / name / "__pycache__" / "one.f-1.py311.nbi" for name in FOLDERS]
    for cache in caches:
        cache.touch()
    return caches


def test_caches_live_as_long_as_all_sources_are_the_same(package: Path) -> None:
    forget_stale(package)
    caches = compile_all(package)
    forget_stale(package)
    assert all(cache.exists() for cache in caches)


@pytest.mark.parametrize("changed", FOLDERS)
def test_caches_in_all_folders_go_when_any_source_changes(package: Path, changed: str) -> None:
    forget_stale(package)
    caches = compile_all(package)
    (package / changed / "one.py").write_text("NAME = 'new'")
    forget_stale(package)
    assert not any(cache.exists() for cache in caches)


def test_caches_of_unknown_sources_go(package: Path) -> None:
    caches = compile_all(package)
    forget_stale(package)
    assert not any(cache.exists() for cache in caches)


def test_other_files_and_absent_folders_are_left_alone(package: Path, tmp_path: Path) -> None:
    other = package / "geometry" / "__pycache__" / "one.cpython-311.pyc"
    other.touch()
    forget_stale(package)
    assert other.exists()
    forget_stale(tmp_path / "nowhere")
