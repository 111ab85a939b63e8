"""The page as a browser shows it: what each control changes, seen in pixels and in the state."""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import v3dcad
from tests.view.page.conftest import HOSTILE
from tests.view.page.shown import Shown, changed
from v3dcad.model import Mesh
from v3dcad.parts import MeshPart
from v3dcad.view.targets.declared import TARGETS

pytestmark = pytest.mark.slow

SAMPLE = Path(__file__).parents[3] / "samples" / "pyramid.stl"

FIRST = {
    "target": "full", "form": "walls", "layer": 24, "cell": -1, "neighbour": -1, "part": True,
    "clip": "off", "at": 50, "flip": False, "travels": True, "seams": True, "playing": False,
    "theme": "light",
}  # fmt: skip


@pytest.fixture(scope="module")
def opened(browser: Any, page_file: Path) -> Iterator[Shown]:
    shown = Shown(browser, page_file)
    yield shown
    shown.close()


@pytest.fixture
def page(opened: Shown) -> Shown:
    opened.run("() => v3dcad.stage.home()")
    opened.set(**FIRST)
    return opened


def test_it_asks_nothing_of_the_network(page: Shown, page_file: Path) -> None:
    assert {url.split(":")[0] for url in page.requests} <= {"file", "data"}
    assert [url for url in page.requests if url.startswith("file")] == [page_file.as_uri()]


def test_a_hostile_name_is_text(page: Shown) -> None:
    assert page.tab.title() == HOSTILE
    assert page.tab.locator("h1").text_content() == HOSTILE
    assert page.tab.locator("script").count() == 3


def test_nothing_from_outside_runs_or_loads(browser: Any, page_file: Path) -> None:
    shown = Shown(browser, page_file, offline=False)
    refused = shown.run(
        """async () => {
            const refused = [];
            addEventListener("securitypolicyviolation",
                event => refused.push(event.effectiveDirective));
            const add = (tag, values) =>
                document.body.append(Object.assign(document.createElement(tag), values));
            add("script", { textContent: "globalThis.ran = true" });
            add("script", { src: "https://example.org/a.js" });
            add("img", { src: "https://example.org/a.png" });
            add("iframe", { src: "https://example.org/" });
            add("style", { textContent: "body { display: none }" });
            await fetch("https://example.org/").catch(() => 0);
            await new Promise(done => setTimeout(done, 200));
            return { refused, ran: globalThis.ran === true };
        }"""
    )
    directives = {"script-src-elem", "img-src", "frame-src", "style-src-elem", "connect-src"}
    assert set(refused["refused"]) == directives
    assert not refused["ran"]
    shown.complaints.clear()  # of what was refused
    shown.close()


def test_the_slider_takes_layers_away(page: Shown) -> None:
    whole = page.picture()
    page.tab.locator("#layer").fill("8")
    page.settle()
    assert page.state("layer") == 8
    assert "Layer 8 of 0 … 24, 17 mm" in page.tab.locator("#layer-text").text_content()
    assert changed(whole, page.picture()) > 0.05


@pytest.mark.parametrize("form", ["layers", "struts"])
def test_forms_look_different(page: Shown, form: str) -> None:
    walls = page.picture()
    page.tab.locator("#form").select_option(form)
    page.settle()
    assert page.state("form") == form
    assert changed(walls, page.picture()) > 0.05


def test_every_target_looks_different(page: Shown, structure: v3dcad.Structure) -> None:
    layer = structure.layers[10]
    cell = int(layer.diagram.sites()[3])
    pairs = layer.diagram.neighbours
    neighbour = int(pairs[(pairs == cell).any(axis=1)][0].sum() - cell)
    page.set(layer=10, cell=cell, neighbour=neighbour)
    pictures = {}
    for target in TARGETS:
        page.tab.locator("#target").select_option(target)
        page.set(layer=10)
        assert page.tab.locator("#shows").text_content() == TARGETS[target].shows
        pictures[target] = page.picture()
    for one in TARGETS:
        for other in TARGETS:
            assert one >= other or changed(pictures[one], pictures[other]) > 0.001, (one, other)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_the_clipping_plane_cuts(page: Shown, axis: str) -> None:
    whole = page.picture()
    page.tab.locator("#clip").select_option(axis)
    page.settle()
    cut = page.picture()
    page.tab.locator("#flip").check()
    page.settle()
    assert changed(whole, cut) > 0.02
    assert changed(cut, page.picture()) > 0.02
    page.set(flip=False, at=100)
    assert changed(whole, page.picture()) < 0.001, "at 100 % nothing is taken away"


def test_a_click_tells_of_the_cell(page: Shown, structure: v3dcad.Structure) -> None:
    layer = structure.layers[12]
    areas = layer.diagram.areas(len(layer.state.sites))
    cell = int(np.argmax(areas))
    ring = layer.diagram.cells()[cell][0]
    page.set(target="layer", layer=12)
    page.tab.mouse.click(*page.on_screen((*ring.mean(axis=0), layer.z)))
    page.settle()
    assert page.state("cell") == cell
    card = page.tab.locator("#card")
    told = dict(
        zip(card.locator("dt").all_text_contents(), card.locator("dd").all_text_contents(),
            strict=True)
    )  # fmt: skip
    number = {name: float(text.split()[0]) for name, text in told.items() if "mm²" in text}
    assert number["area on this layer"] == pytest.approx(areas[cell], rel=1e-3)
    volume = sum(one.diagram.areas(len(areas))[cell] for one in structure.layers) * 2.0
    assert float(told["volume"].split()[0]) == pytest.approx(volume, rel=1e-3)
    site = [float(word.strip(",")) for word in told["site"].split()[:3]]
    assert site == pytest.approx(structure.sites[cell], rel=1e-3, abs=1e-3)
    pairs = layer.diagram.neighbours
    beside = np.unique(pairs[(pairs == cell).any(axis=1)])
    shown = card.locator(".neighbours button").all_text_contents()
    assert [int(text) for text in shown] == beside[beside != cell].tolist()
    card.locator(".neighbours button").first.click()
    assert page.state("cell") == beside[beside != cell][0]
    page.tab.locator("#canvas").click(position={"x": 5, "y": 5})
    assert page.state("cell") == -1
    assert card.is_hidden()


def test_a_click_on_a_hole_or_a_cut_away_part_goes_through(page: Shown) -> None:
    """In front of the plane there is nothing to click; what lies behind is met instead."""
    middle = page.on_screen((0.0, 0.0, 48.0))
    page.tab.mouse.click(*middle)
    whole = page.state("cell")
    page.set(clip="z", at=80)
    page.tab.mouse.click(*middle)
    assert page.state("cell") not in (-1, whole)


def test_a_cell_that_is_not_there_is_told(page: Shown) -> None:
    page.tab.locator("#cell").fill("99999")
    page.tab.locator("#cell").press("Enter")
    assert page.tab.locator("#message").text_content() == (
        "There is no cell 99999: click one in the part."
    )
    assert page.state("cell") == -1
    page.tab.locator("#canvas").click(position={"x": 5, "y": 5})
    assert page.tab.locator("#message").is_hidden()


def test_toolpath_and_layers_go_together(page: Shown) -> None:
    page.set(target="toolpath", layer=24)
    total = page.state("time")
    whole = page.picture()
    page.set(layer=5)
    assert 0 < page.state("time") < total
    assert changed(whole, page.picture()) > 0.05
    page.tab.locator("#time").fill(str(total / 2))
    page.settle()
    assert 5 < page.state("layer") < 24
    with_travel = page.picture()
    page.tab.locator("#travels").uncheck()
    page.tab.locator("#seams").uncheck()
    page.settle()
    assert changed(with_travel, page.picture()) > 0.0005
    assert page.tab.locator("#legend li").all_text_contents() == ["bead", "perimeter"]


def test_play_goes_up_and_stops(page: Shown) -> None:
    page.set(layer=23)
    page.tab.locator("#play").click()
    page.tab.wait_for_function("() => !v3dcad.state.values.playing", timeout=20_000)
    assert page.state("layer") == 24


def test_keys(page: Shown) -> None:
    page.tab.locator("#canvas").focus()
    for key, name, value in [
        ("ArrowDown", "layer", 23), ("PageDown", "layer", 13), ("Home", "layer", 0),
        ("ArrowUp", "layer", 1), ("End", "layer", 24), ("p", "part", False), ("c", "clip", "y"),
        ("c", "clip", "off"),
    ]:  # fmt: skip
        page.tab.keyboard.press(key)
        assert page.state(name) == value, key
    page.set(cell=100)
    page.tab.keyboard.press("Escape")
    assert page.state("cell") == -1
    before = page.picture()
    page.tab.keyboard.press("ArrowLeft")
    page.settle()
    assert changed(before, page.picture()) > 0.02


def test_dark_and_light(page: Shown) -> None:
    light = page.picture()
    page.tab.locator("#theme").click()
    page.settle()
    dark = page.picture()
    assert page.state("theme") == "dark"
    assert light[20, 20].min() > 230
    assert dark[20, 20].max() < 40


def test_few_draw_calls(page: Shown) -> None:
    for target in TARGETS:
        page.set(target=target, cell=-1)
        assert page.calls() <= 9, target


def test_where_frames_are_slow_fewer_segments_are_drawn_in_motion(
    browser: Any, page_file: Path
) -> None:
    page = Shown(browser, page_file)  # whose eye has not moved yet
    drawn = """async wait => {
        await new Promise(done => setTimeout(done, wait));
        v3dcad.stage.draw();
        return v3dcad.stage.renderer.info.render.triangles;
    }"""
    whole, picture = page.run(drawn, 0), page.picture()
    page.run("() => { v3dcad.stage.paced(1000); v3dcad.stage.move(); v3dcad.stage.paced(50); }")
    assert page.run(drawn, 0) == whole, "frames are fast, or the eye rests"
    page.run("() => { v3dcad.stage.paced(1000); v3dcad.stage.paced(1000); }")
    assert whole / 5 < page.run(drawn, 0) < whole / 3
    page.run("() => { v3dcad.stage.rest(); v3dcad.stage.move(); }")
    assert page.run(drawn, 400) < whole / 3, "the motion goes on"
    page.run("() => v3dcad.stage.rest()")
    assert page.run(drawn, 400) == whole
    assert changed(picture, page.picture()) == 0
    page.run("() => v3dcad.stage.move()")
    assert page.run(drawn, 0) < whole / 3, "as fast as the last motion"
    page.close()


def test_memory_stays_flat(page: Shown) -> None:
    protocol = page.context.new_cdp_session(page.tab)
    page.set(target="neighbours", cell=100)

    def used() -> tuple[float, dict[str, int]]:
        protocol.send("HeapProfiler.collectGarbage")
        heap = protocol.send("Runtime.getHeapUsage")["usedSize"] / 1e6
        return heap, page.run("() => ({ ...v3dcad.stage.renderer.info.memory })")

    def steps(count: int) -> None:
        page.run(
            """count => {
                for (let k = 0; k < count; k++) {
                    v3dcad.state.set({ layer: k % 25 });
                    v3dcad.stage.draw();
                }
            }""",
            count,
        )

    steps(25)
    heap, held = used()
    steps(200)
    heap_after, held_after = used()
    assert heap_after < heap + 1
    assert held_after == held


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_nobody_is_shut_out(browser: Any, page_file: Path, scheme: str) -> None:
    # The package reads its script in the locale's encoding, which need not be UTF-8.
    package = find_spec("axe_playwright_python")
    if package is None or package.origin is None:
        pytest.skip("needs .[test]")
    axe = Path(package.origin).with_name("axe.min.js").read_text(encoding="utf-8")
    shown = Shown(browser, page_file, color_scheme=scheme)
    shown.tab.evaluate(axe)
    for values in ({}, {"target": "toolpath"}, {"target": "sizes", "cell": 100, "clip": "x"}):
        shown.set(**values)
        for section in shown.tab.locator("#sheet details > summary").all():
            section.click()
        found = shown.run("async () => (await axe.run()).violations")
        assert not found, json.dumps(found, indent=1)
    shown.close()


def test_on_a_phone(browser: Any, page_file: Path) -> None:
    size = {"width": 390, "height": 780}
    shown = Shown(browser, page_file, viewport=size, has_touch=True, is_mobile=True)
    assert shown.run("() => document.documentElement.scrollWidth") == size["width"]
    shown.set(target="layer", layer=12)
    shown.tab.touchscreen.tap(*shown.on_screen((0.0, 0.0, 24.0)))
    shown.settle()
    assert shown.state("cell") >= 0
    assert shown.tab.locator("#card").is_visible()
    shown.close()


def test_a_notebook_shows_it_in_a_frame(browser: Any, structure: v3dcad.Structure) -> None:
    html = structure._repr_html_()
    assert len(html) < 4_000_000
    context = browser.new_context(offline=True)
    tab = context.new_page()
    tab.set_content(f"<!doctype html><title>notebook</title>{html}<p style='height: 200vh'>")
    frame = tab.frame_locator("iframe")
    frame.locator("#app[data-ready]").wait_for(timeout=60_000)
    assert frame.locator("h1").text_content() == HOSTILE
    assert "toolpath" not in frame.locator("#target option").all_text_contents()
    within = next(one for one in tab.frames if one.parent_frame)

    away = "v3dcad.stage.camera.position.distanceTo(v3dcad.stage.middle)"
    before = within.evaluate(f"() => {away}")
    tab.mouse.move(600, 200)
    tab.mouse.wheel(0, 300)
    tab.wait_for_function("() => scrollY > 0")
    assert within.evaluate(f"() => {away}") == before, "the wheel scrolls the notebook"
    tab.evaluate("() => scrollTo(0, 0)")
    frame.locator("#canvas").click(position={"x": 5, "y": 5})
    tab.mouse.wheel(0, 300)
    within.wait_for_function(f"before => {away} > 1.1 * before", arg=before)
    assert tab.evaluate("() => scrollY") == 0, "once clicked, it zooms"
    context.close()


def test_huge_structures_are_thinned_and_say_so(
    browser: Any, structure: v3dcad.Structure, tmp_path: Path
) -> None:
    file = tmp_path / "thin.html"
    edges = sum(len(layer.diagram.edges) for layer in structure.layers)
    file.write_text(structure.page(most=edges // 3), encoding="utf-8")
    shown = Shown(browser, file)
    said = shown.tab.locator("#note").text_content()
    assert said.startswith("Thinned: 7 of 25 layers are shown, one in 4.")
    shown.set(layer=6)
    assert "Layer 24 of 0 … 24" in shown.tab.locator("#layer-text").text_content()
    shown.close()


def test_walls_of_a_layer_reach_from_its_lower_to_its_upper_end(page: Shown) -> None:
    """Sections lie in the middle of layers of 2 mm: seen from the front, the first stands on 0."""
    background = page.picture()[5, 5]
    page.set(layer=0, part=False)
    page.run("() => v3dcad.stage.look([0, -1, 0])")
    page.settle()
    different = np.abs(page.picture() - background).max(axis=2) > 24
    canvas, footer = (page.tab.locator(one).bounding_box()["y"] for one in ("#canvas", "footer"))
    rows = np.flatnonzero(different[: int(footer - canvas) - 2].any(axis=1))
    nearest, farthest = v3dcad.place_on_bed(SAMPLE).bounds[:, 1].tolist()
    top, bottom = (
        page.on_screen((0.0, y, z))[1] - canvas for y, z in ((farthest, 2.0), (nearest, 0.0))
    )
    assert rows.min() == pytest.approx(top, abs=3)
    assert rows.max() == pytest.approx(bottom, abs=3)


def test_walls_go_on_to_where_they_are_between_the_layers(
    page: Shown, structure: v3dcad.Structure
) -> None:
    """The ends of strips half a millimetre above a section, against the section there.

    Only what meets something else on the way lies elsewhere: a few.
    """
    rise, layer = 0.5, structure.layers[10]
    pairs, ends, packed = page.run(
        """layer => {
            const { arrays, walls, slopes } = v3dcad.structure;
            const [first, end] = v3dcad.structure.rows("walls", layer);
            const rows = (array, width) => [...array.subarray(width * first, width * end)];
            return [rows(arrays.wall_sites, 2), rows(walls, 6), rows(slopes, 1)];
        }""",
        layer.index,
    )
    ends = np.reshape(ends, (-1, 2, 3))[:, :, :2]
    degrees = np.array(packed, np.int64)[:, None] // [1, 256, 65536] % 256 - 90
    lean, *along = np.tan(np.radians(degrees)).T
    way = ends[:, 1] - ends[:, 0]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    left = way[:, ::-1] * [-1, 1]
    speeds = (
        lean[:, None, None] * left[:, None] + np.stack(along, axis=1)[:, :, None] * way[:, None]
    )
    above = structure.at(layer.z + rise)
    there = dict(
        zip(map(tuple, above.edge_sites.tolist()), above.vertices[above.edges], strict=True)
    )
    errors = [
        np.linalg.norm(end + rise * speed - there[pair], axis=1)
        for pair, end, speed in zip(
            map(tuple, np.reshape(pairs, (-1, 2)).tolist()), ends, speeds, strict=True
        )
        if pair in there
    ]
    assert len(errors) > 50
    assert np.quantile(errors, 0.95) < 0.02


def test_strips_end_at_the_sides_of_the_part(browser: Any, tmp_path: Path) -> None:
    """Sides of 45° and layers of 2 mm: hardly a pixel is drawn beside the part's silhouette."""
    low, high = (np.array([[-r, -r], [r, -r], [r, r], [-r, r]]) for r in (30.0, 10.0))
    corners = np.concatenate(
        [np.column_stack([low, [0.0] * 4]), np.column_stack([high, [20.0] * 4])]
    )
    sides = [[[k, (k + 1) % 4, 4 + k], [4 + k, (k + 1) % 4, 4 + (k + 1) % 4]] for k in range(4)]
    triangles = np.array([[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], *np.concatenate(sides)])
    part = MeshPart("frustum", Mesh(corners, triangles))
    file = tmp_path / "frustum.html"
    file.write_text(v3dcad.fill(part, layer_height=2.0, cell_size=8.0).page(), encoding="utf-8")
    shown = Shown(browser, file)
    shown.set(part=False)
    shown.run("() => v3dcad.stage.look([0, -1, 0])")
    shown.settle()
    picture = shown.picture()[:-2]
    y, x = np.nonzero(np.abs(picture - picture[5, 5]).max(axis=2) > 24)
    box = shown.tab.locator("#canvas").bounding_box()
    outline = shapely.MultiPoint([shown.on_screen(tuple(one)) for one in corners]).convex_hull
    pixels = shapely.points(x + box["x"] + 0.5, y + box["y"] + 0.5)
    beside = shapely.distance(outline, pixels)
    assert (beside > 1.5).sum() < 40, "it was 93 while strips ended upright"
    shown.close()
