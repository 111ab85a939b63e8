"""What README shows is run."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def test_the_python_example_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, re.S)
    (tmp_path / "example.py").write_text(code, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    runpy.run_path("example.py")
    assert (tmp_path / "walls.step").stat().st_size > 1000
    assert (tmp_path / "walls.gcode").stat().st_size > 1000
    assert len(capsys.readouterr().out.splitlines()) == 40


def test_the_options_shown_exist_with_these_defaults() -> None:
    from v3dcad import FillSettings, PrintSettings
    from v3dcad.settings import ExportSettings

    rows = re.findall(r"^\| `--([a-z-]+)` \| ([^ |]*)", README, re.M)
    assert len(rows) == 10
    for name, default in rows:
        field = name.replace("-", "_")
        classes = (FillSettings, PrintSettings, ExportSettings)
        known = [cls for cls in classes if field in cls.__dataclass_fields__]
        if name != "sites-file":
            assert [str(getattr(cls(), field)) for cls in known] == [default]


def test_files_that_are_linked_are_there() -> None:
    for target in re.findall(r"\]\(([^)]+)\)", README):
        assert (Path(__file__).parent.parent / target.partition("#")[0]).exists(), target
