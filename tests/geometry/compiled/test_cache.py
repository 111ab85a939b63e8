"""Where compiled code is kept, and that none of older sources is."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from numba.core import config
from numba.core.caching import UserProvidedCacheLocator

from v3dcad.errors import V3dcadError
from v3dcad.geometry.compiled.cache import settle_caches

FOLDERS = ["geometry", "geometry/clipping", "structure", "structure/sweep/deep"]


@pytest.fixture
def package(tmp_path: Path) -> Path:
    for name in FOLDERS:
        (tmp_path / "package" / name / "__pycache__").mkdir(parents=True)
        (tmp_path / "package" / name / "one.py").write_text(f"NAME = {name!r}")
    return tmp_path / "package"


@pytest.fixture(autouse=True)
def surroundings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A home and a temporary folder of the test's own."""
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "MPLCONFIGDIR"):
        monkeypatch.setenv(name, "")  # so that it is put back as it was, even if there was none
        monkeypatch.delenv(name)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    config.reload_config()
    yield
    monkeypatch.undo()
    config.reload_config()


def beside(package: Path) -> list[Path]:
    return [package / name / "__pycache__" for name in FOLDERS]


def below(root: Path, package: Path) -> list[Path]:
    """Folders as numba names them in a cache that is not beside the sources."""
    subpath = UserProvidedCacheLocator.get_suitable_cache_subpath
    return [root / subpath(str(package / name / "one.py")) for name in FOLDERS]


def compile_all(places: list[Path]) -> list[Path]:
    """What numba leaves behind."""
    caches = [place / "one.f-1.py311.nbi" for place in places]
    for cache in caches:
        cache.touch()
    return caches


def make_read_only(package: Path) -> None:
    """Let no `__pycache__` be made in a package, not even by root."""
    for place in beside(package):
        place.rmdir()
        place.touch()


@pytest.mark.parametrize("place", ["beside", "NUMBA_CACHE_DIR", "home", "temporary"])
@pytest.mark.parametrize("changed", [None, *FOLDERS])
def test_code_lives_as_long_as_all_sources_are_the_same(
    place: str,
    changed: str | None,
    package: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    places = {
        "beside": beside(package),
        "NUMBA_CACHE_DIR": below(tmp_path / "named", package),
        "home": below(tmp_path / "home" / ".cache" / "numba", package),
        "temporary": below(tmp_path / "temporary" / f"v3dcad-{os.getuid()}", package),
    }[place]
    if place == "NUMBA_CACHE_DIR":
        monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "named"))
        config.reload_config()
    elif place != "beside":
        make_read_only(package)
    if place == "temporary":
        monkeypatch.setenv("HOME", "/dev/null")
    settle_caches(package)
    caches = compile_all(places)
    if changed is not None:
        (package / changed / "one.py").write_text("NAME = 'new'")
    settle_caches(package)
    assert {cache.exists() for cache in caches} == {changed is None}


def test_code_of_unknown_sources_goes(package: Path) -> None:
    caches = compile_all(beside(package))
    settle_caches(package)
    assert not any(cache.exists() for cache in caches)


def test_other_files_and_absent_folders_are_left_alone(package: Path, tmp_path: Path) -> None:
    other = package / "geometry" / "__pycache__" / "one.cpython-311.pyc"
    other.touch()
    settle_caches(package)
    assert other.exists()
    settle_caches(tmp_path / "nowhere")


def test_where_nothing_can_be_written_a_temporary_folder_is_said_once(
    package: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    make_read_only(package)
    monkeypatch.setenv("HOME", "/dev/null")
    folder = tmp_path / "temporary" / f"v3dcad-{os.getuid()}"
    settle_caches(package)
    said = capsys.readouterr().err
    assert os.environ["MPLCONFIGDIR"] == str(folder / "matplotlib")
    assert said.count("\n") == 1
    assert str(folder) in said
    assert "NUMBA_CACHE_DIR" in said
    assert folder.stat().st_mode & 0o777 == 0o700
    assert os.environ["NUMBA_CACHE_DIR"] == config.CACHE_DIR == str(folder)
    monkeypatch.delenv("NUMBA_CACHE_DIR")  # another process
    config.reload_config()
    settle_caches(package)
    assert str(folder) == config.CACHE_DIR
    assert capsys.readouterr().err == ""


def test_without_a_home_no_folder_of_that_name_is_made(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_read_only(package)
    monkeypatch.setattr("os.path.expanduser", lambda path: path)  # as for a user without a name
    monkeypatch.chdir(tmp_path)
    settle_caches(package)
    assert config.CACHE_DIR.startswith(str(tmp_path / "temporary"))
    assert not (tmp_path / "~").exists()


@pytest.mark.parametrize("held", ["open", "another's", "a link", "a file"])
def test_a_folder_that_others_may_write_to_is_not_used(
    held: str,
    package: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    make_read_only(package)
    monkeypatch.setenv("HOME", "/dev/null")
    folder = tmp_path / "temporary" / f"v3dcad-{os.getuid()}"
    if held == "another's":
        monkeypatch.setattr("os.getuid", lambda: 12345)
        folder = folder.with_name("v3dcad-12345")
    if held == "a link":
        (tmp_path / "aside").mkdir(mode=0o700)
        folder.symlink_to(tmp_path / "aside")
    elif held == "a file":
        folder.touch(mode=0o600)
    else:
        folder.mkdir(mode=0o700)
        folder.chmod(0o777 if held == "open" else 0o700)
    settle_caches(package)
    used = Path(config.CACHE_DIR)
    assert used.parent == tmp_path / "temporary"
    assert used != folder
    assert used.stat().st_mode & 0o777 == 0o700
    assert f"{folder} is open to others and not used" in capsys.readouterr().err


def test_old_code_that_cannot_be_deleted_is_refused(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    compile_all(beside(package))
    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(V3dcadError, match="older sources that cannot be deleted"):
        settle_caches(package)
