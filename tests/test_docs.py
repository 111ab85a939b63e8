"""What docs/scripting.md, worker.md and seeing.md show is run, and so are the sample scripts."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest
from hosts import cadquery_or_skip

from v3dcad.view.targets.declared import TARGETS

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parent.parent
GUIDE = (ROOT / "docs" / "scripting.md").read_text(encoding="utf-8")


@pytest.mark.filterwarnings("ignore:.* narrower than a .*, and filled solid")
def test_scripting_guide_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("guide.py").write_text("\n".join(re.findall(r"```python\n(.*?)```", GUIDE, re.S)), "utf-8")
    made = runpy.run_path("guide.py")
    assert made["frame"].volume < made["part"].volume
    assert made["post"].part.volume < 3.2 * 12**2 * 30
    assert 0 < made["around"].area < made["walls"].area
    for name in ("cells.step", "thick.step", "walls.stl", "beams.3mf", "layer.svg"):
        assert (tmp_path / name).stat().st_size > 1000


def test_the_conversation_with_the_worker_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (ROOT / "docs" / "worker.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, re.S)
    (tmp_path / "example.py").write_text(code, encoding="utf-8")
    monkeypatch.chdir(ROOT)
    runpy.run_path(str(tmp_path / "example.py"))
    said = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r"[0-9]+ edges on [0-9]+ layers", said[-1])
    assert "filling 0 of" in "".join(said)


def test_the_guide_to_seeing_runs_and_names_every_target(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (ROOT / "docs" / "seeing.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `(\w+)` \|", text, re.M) == list(TARGETS)
    (code,) = re.findall(r"```python\n(.*?)```", text, re.S)
    (tmp_path / "guide.py").write_text(code, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    made = runpy.run_path("guide.py")
    assert made["picture"].startswith(b"\x89PNG")
    assert (tmp_path / "layer.svg").stat().st_size > 1000


def test_the_gallery_shows_each_of_its_pictures() -> None:
    text = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    shown = re.findall(r"\]\((gallery/[^)]+)\)", text)
    there = [f"gallery/{file.name}" for file in (ROOT / "docs" / "gallery").iterdir()]
    assert sorted(shown) == sorted(there)
    assert all((ROOT / "docs" / file).stat().st_size <= 64_000 for file in there)


@pytest.mark.filterwarnings("ignore:.* narrower than a .*, and filled solid")
def test_cadquery_guide_and_sample_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cadquery_or_skip()
    monkeypatch.chdir(tmp_path)
    snippets = re.findall(r"```cadquery\n(.*?)```", GUIDE, re.S)
    Path("guide.py").write_text("\n".join(snippets), encoding="utf-8")
    made = runpy.run_path("guide.py")
    whole = made["plate"].val().Volume()
    for cells in (made["cells"], made["graded"]):
        assert sum(cell.Volume() for cell in cells.vals()) == pytest.approx(whole, rel=1e-8)
    assert 0 < made["light"].val().Volume() < whole
    runpy.run_path(str(ROOT / "samples" / "scripts" / "cadquery_parts.py"))
    assert Path("cadquery_parts.step").stat().st_size > 10_000


@pytest.mark.filterwarnings("ignore:.* narrower than a .*, and filled solid")
@pytest.mark.parametrize(
    "name",
    [
        "lightened_bracket",
        "foam_and_columns",
        "graded_bracket",
        "graded_lamp",
        "insole",
        "stressed_bar",
        pytest.param("foam_lamp_shade", marks=pytest.mark.long),
    ],
)
def test_sample_scripts_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(ROOT / "samples" / "scripts" / f"{name}.py"))
    assert any(file.stat().st_size > 10_000 for file in tmp_path.iterdir())
