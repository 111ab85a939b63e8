from __future__ import annotations

import base64
import io
import itertools
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from diagrams import WIDE, area_of, disc, layer, scattered, square, stack
from hypothesis import given
from hypothesis import strategies as st
from simulated_printer import Printer

import v3dcad
from v3dcad.errors import SettingError
from v3dcad.formats.gcode.blocks import duration_text
from v3dcad.formats.gcode.lines import COLUMNS, DECIMALS, Lines, rendered
from v3dcad.formats.gcode.reader import read_gcode
from v3dcad.formats.gcode.writer import Totals, check_fits, write_gcode
from v3dcad.geometry.print_time import step_seconds
from v3dcad.model import EXTRUDE, RETRACT, TRAVEL, Layer, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.trace import trace

pytestmark = pytest.mark.slow

FILAMENT = np.pi / 4 * 1.75**2


def wide(**settings: Any) -> PrintSettings:
    return PrintSettings(**{**WIDE, **settings})


def written(layers: list[Layer], *, thesis: bool = False, **settings: Any) -> tuple[str, Totals]:
    return written_with(wide(**settings), layers, thesis=thesis)


def written_with(
    options: PrintSettings, layers: list[Layer], *, thesis: bool = False
) -> tuple[str, Totals]:
    stream = io.StringIO()
    totals = write_gcode(stream, trace(layers, options, thesis=thesis), options)
    return stream.getvalue(), totals


@pytest.mark.parametrize("thesis", [False, True])
@pytest.mark.parametrize("extrusion", ["absolute", "relative"])
@pytest.mark.parametrize("contour", ["inset", "centre"])
def test_a_printer_lays_every_edge_and_all_the_filament(
    thesis: bool, extrusion: str, contour: str
) -> None:
    layers = stack(4, 20)
    text, totals = written(
        layers,
        thesis=thesis,
        extrusion=extrusion,
        contour=contour,
        retraction=1.5,
        z_hop=0.4,
        minimum_edge=0.0,
        flow=95.0,
        first_layer_flow=110.0,
    )
    printer = Printer().run(text)
    expected = 0.0
    for made in layers:
        area = area_of(made.section)
        inside = area.buffer(-0.4, join_style="mitre") if contour == "inset" else area
        inner = made.diagram.edges[made.diagram.inner()]
        cells = shapely.intersection(
            shapely.multilinestrings(shapely.linestrings(made.diagram.vertices[inner])), inside
        )
        moves = [m for m in printer.printing() if m.layer == made.index]
        lines = shapely.linestrings([(m.start[:2], m.stop[:2]) for m in moves])
        lines = shapely.transform(lines, lambda points: points - 110)
        once = cells.length + inside.boundary.length
        assert shapely.union_all(lines).length == pytest.approx(once, rel=1e-5)
        # What is passed twice is about a fifth; the thesis's order passes nothing twice.
        passed = shapely.length(lines).sum() / once
        assert passed == pytest.approx(1.0, rel=1e-5) if thesis else 1.05 < passed < 1.4
        wanted = shapely.union(cells, inside.boundary)
        assert shapely.union_all(lines).buffer(2e-3).covers(wanted)
        assert wanted.buffer(2e-3).covers(shapely.union_all(lines))
        assert {m.stop[2] for m in moves} == {round(made.z + 0.2, 3)}
        flow = 1.1 if made.index == 0 else 0.95
        expected += wanted.buffer(0.4).area * 0.2 * flow / FILAMENT  # what all beads cover
    found = sum(m.extruded for m in printer.printing())
    assert found == pytest.approx(expected, rel=0.04)  # beads of 0.8 mm, cells of 4.5 mm
    assert totals.filament_mm == pytest.approx(found, rel=1e-6)
    assert printer.retracted == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("section", [square(10), square(10, hole=3), disc(10)])
def test_nothing_is_extruded_outside_the_section_grown_by_half_a_bead(section: object) -> None:
    made = layer(scattered(20, 10, 3), section)  # type: ignore[arg-type]
    for contour in ("inset", "centre"):
        text, _ = written([made], contour=contour, arcs=True)
        printer = Printer().run(text)
        straight = [m for m in printer.printing() if not m.arc]
        beads = shapely.union_all(
            [
                shapely.LineString([m.start[:2], m.stop[:2]]).buffer(0.4, cap_style="flat")
                for m in straight
            ]
        )
        grown = area_of(made.section).buffer(0.4 + 2e-3)
        assert grown.covers(shapely.transform(beads, lambda points: points - 110))


def test_layers_ascend_and_moves_stay_on_the_bed() -> None:
    text, _ = written(stack(5), retraction=1.0, z_hop=1.0, thesis=True, skirt_loops=2)
    printer = Printer().run(text)
    heights = [m.stop[2] for m in printer.printing()]
    assert heights == sorted(heights)
    assert sorted(set(heights)) == pytest.approx([0.2, 0.4, 0.6, 0.8, 1.0])
    for m in printer.moves:
        if m.layer >= 0 and m is not printer.moves[-1]:
            assert 0 <= m.stop[0] <= 220
            assert 0 <= m.stop[1] <= 220


def test_relative_extrusion_never_drifts() -> None:
    layers = stack(40, 20)
    text, totals = written(layers, extrusion="relative")
    found = sum(m.extruded for m in Printer().run(text).printing())
    assert found == pytest.approx(totals.filament_mm, abs=1.01e-5)


def test_arcs_are_written_as_arcs_and_paid_by_their_length() -> None:
    made = layer(scattered(20, 10, 3), disc(14))
    text, _ = written([made], thesis=True, arcs=True)
    printer = Printer().run(text)
    arcs = [m for m in printer.printing("WALL-OUTER") if m.arc]
    assert sum(m.length for m in arcs) == pytest.approx(2 * np.pi * 13.6, rel=1e-4)
    # Where walls end on them, they have less room.
    assert 0.95 < sum(m.extruded for m in arcs) / (2 * np.pi * 13.6 * 0.8 * 0.2 / FILAMENT) < 1
    assert not [m for m in printer.printing("FILL") if m.arc]
    plain, _ = written([made])
    assert len(text) < 0.8 * len(plain)
    assert "G2" not in re.findall(r"^G\d+", plain, re.M)


def test_a_ring_alone_is_two_half_turns() -> None:
    made = layer(np.array([[0.0, 0.0]]), disc(14))
    printer = Printer().run(written([made], arcs=True)[0])
    arcs = [m for m in printer.printing() if m.arc]
    assert len(arcs) <= 3
    assert sum(m.length for m in arcs) == pytest.approx(2 * np.pi * 13.6, rel=1e-4)
    assert sum(m.extruded for m in arcs) == pytest.approx(
        2 * np.pi * 13.6 * 0.8 * 0.2 / FILAMENT, rel=1e-5
    )


@pytest.mark.parametrize("flavour", ["marlin", "reprapfirmware", "klipper"])
def test_firmware_retraction(flavour: str) -> None:
    text, _ = written(stack(2, 20), flavour=flavour, retraction_by="firmware", thesis=True)
    printer = Printer().run(text)
    assert printer.commands.count("G10") == printer.commands.count("G11") > 3
    assert printer.retracted == 0


def test_header_says_what_the_print_takes() -> None:
    layers = stack(3)
    text, totals = written(layers)
    paths = list(trace(layers, wide()))
    starts = [paths[0].points[0], *(path.points[-1] for path in paths[:-1])]
    seconds = [
        step_seconds(path, start, wide()).sum() for path, start in zip(paths, starts, strict=True)
    ]
    volume = sum(path.volume.sum() for path in paths)
    assert totals.time_s == pytest.approx(sum(seconds))
    assert totals.mass_g == pytest.approx(volume * 1.24e-3)
    assert totals.filament_mm == pytest.approx(volume / (np.pi / 4 * 1.75**2))
    assert f";TIME:{totals.time_s:.0f}\n" in text
    assert f"; filament used [mm] = {totals.filament_mm:.2f}\n" in text
    assert f"; filament used [g] = {totals.mass_g:.2f}\n" in text
    assert ";LAYER_COUNT:3\n" in text
    assert re.findall(r"^;LAYER:(\d+)$", text, re.M) == ["0", "1", "2"]
    assert ";MINX:100.400\n" in text


def test_comments_are_those_that_viewers_know_by_the_name_in_the_header() -> None:
    """PrusaSlicer's GCodeProcessor.cpp and Moonraker's metadata.py look for Cura's engine by name,
    up to the first they find, and then for these words; others are shown as unknown.
    """
    known = {"WALL-OUTER", "WALL-INNER", "FILL", "SKIN", "SKIRT"}
    layers = [layer(scattered(12, 8, 1), square(8, z=0.2 * k), k) for k in range(4)]
    shown = {"perimeters": 2, "bottom_layers": 0, "top_layers": 2, "skirt_loops": 1}
    text, _ = written(layers, wall_beads=2, open=False, **shown)
    header = text[: text.index(";LAYER:0")]
    assert re.findall(r"Cura_SteamEngine\s(.*)", header) == ["(v3dcad)"]
    assert not re.search("PrusaSlicer|SuperSlicer|Slic3r|OrcaSlicer|BambuStudio", header)
    assert set(re.findall(r"^;TYPE:(.*)$", text, re.M)) == known
    assert ";BRIDGE\n" in text


def test_the_header_says_how_high_layers_are() -> None:
    for count, said in ((1, 0.25), (2, 0.2), (5, 0.2)):
        text, _ = written(stack(count), first_layer_height=0.25)
        assert f";Layer height: {said}\n" in text


def test_progress_rises_to_the_end() -> None:
    text, totals = written(stack(30, 30))
    progress = [(int(p), int(r)) for p, r in re.findall(r"^M73 P(\d+) R(\d+)$", text, re.M)]
    assert progress[0] == (0, round(totals.time_s / 60))
    assert progress[-1] == (100, 0)
    assert [p for p, _ in progress] == sorted(p for p, _ in progress)
    assert [r for _, r in progress] == sorted((r for _, r in progress), reverse=True)
    assert len(progress) > 25
    total = totals.time_s / 60
    for percent, minutes in progress:
        assert abs(minutes - total * (1 - percent / 100)) <= 0.5 + total / 100


def test_fan_starts_at_its_layer() -> None:
    text, _ = written(stack(4), fan=40.0, fan_from_layer=2)
    assert text.index(";LAYER:2") < text.index("M106 S102") < text.index(";LAYER:3")
    assert "M106" not in written(stack(4), fan=0.0)[0]


def test_the_fan_speeds_up_evenly() -> None:
    text, _ = written(stack(6), fan=100.0, fan_from_layer=1, fan_full_layer=3)
    found = re.findall(r"^;LAYER:(\d)\nG92 E0\nM106 S(\d+)$", text, re.M)
    assert found == [("1", "85"), ("2", "170"), ("3", "255")]


def test_the_fan_has_its_own_power_on_bridges_and_only_there() -> None:
    options = {"open": False, "bottom_layers": 0, "top_layers": 2, "fan": 40.0, "bridge_fan": 100.0}
    text, _ = written([*stack(6)], fan_from_layer=1, fan_full_layer=1, **options)
    text = text[text.index(";LAYER:1") :].replace(";BRIDGE\n;TYPE:SKIN", ";TYPE:BRIDGE")
    power, what, seen = 0, "", set()
    for line in text.splitlines():
        if line.startswith("M106"):
            power = int(line[6:])
        elif line.startswith(";TYPE:"):
            what = line[6:]
        elif re.match(r"G1 X.* E", line):
            seen.add((what, power))
    assert seen == {("WALL-OUTER", 102), ("FILL", 102), ("BRIDGE", 255), ("SKIN", 102)}


@pytest.mark.parametrize("extrusion", ["absolute", "relative"])
@pytest.mark.parametrize("bed_origin", ["corner", "centre"])
def test_the_prime_line_lies_on_the_bed_and_lays_what_it_has_room_for(
    extrusion: str, bed_origin: str
) -> None:
    text, _ = written(stack(1), prime_line=100.0, extrusion=extrusion, bed_origin=bed_origin)
    lines = [m for m in Printer().run(text).moves if m.layer < 0 and m.prints]
    low = -110 if bed_origin == "centre" else 0
    for move, share in zip(lines, (1.0, 0.5), strict=True):
        assert move.length == pytest.approx(100)
        assert move.extruded * FILAMENT == pytest.approx(100 * 0.2 * 0.6 * share, rel=1e-4)
        assert low < move.stop[0] < low + 5
        assert low < move.stop[1] < low + 220
        assert move.stop[2] == 0.2
    assert not [m for m in Printer().run(written(stack(1))[0]).moves if m.layer < 0 and m.prints]


def test_the_header_names_the_machine() -> None:
    assert "; printer = mine, 0.4 mm\n" in written(stack(1), machine="mine, \n 0.4 mm")[0]


def test_thumbnail_is_the_png() -> None:
    png = b"\x89PNG\r\n\x1a\n" + b"\0\0\0\rIHDR" + (32).to_bytes(4, "big") + (24).to_bytes(4, "big")
    png += bytes(range(256))
    stream = io.StringIO()
    write_gcode(stream, trace(stack(1), wide()), wide(), thumbnail=png)
    text = stream.getvalue()
    found = re.search(r"^; thumbnail begin 32x24 (\d+)\n(.*?)^; thumbnail end$", text, re.M | re.S)
    assert found is not None
    body = "".join(line[2:] for line in found[2].splitlines())
    assert len(body) == int(found[1])
    assert base64.b64decode(body) == png
    with pytest.raises(SettingError, match="not a PNG"):
        write_gcode(io.StringIO(), [], wide(), thumbnail=b"GIF89a")


def test_placeholders_are_filled_in() -> None:
    start = "M104 S{nozzle_temperature}\nM117 {layers} layers, {{braces}}\n"
    text, _ = written(stack(2), nozzle_temperature=215.0, start_gcode=start)
    assert "M104 S215\nM117 2 layers, {braces}\n" in text


def test_unknown_placeholder_before_a_byte_is_written() -> None:
    stream = io.StringIO()
    options = wide(end_gcode="M104 S{temperature}")
    with pytest.raises(SettingError, match=r"end_gcode: \{temperature\} is not a known"):
        write_gcode(stream, trace(stack(1), options), options)
    assert stream.getvalue() == ""


def test_same_bytes_every_time() -> None:
    assert written(stack(3, 30))[0] == written(stack(3, 30))[0]


def test_bed_too_small_before_a_byte_is_written() -> None:
    stream = io.StringIO()
    options = wide(bed="220x18")
    with pytest.raises(SettingError, match=r"bed 220x18: layer 0 goes to y = .* beyond its edge"):
        write_gcode(stream, trace(stack(2), options), options)
    assert stream.getvalue() == ""


def test_too_high_before_a_byte_is_written() -> None:
    stream = io.StringIO()
    options = wide(build_height=0.3)
    with pytest.raises(SettingError, match=r"build_height 0\.3: layer 1"):
        write_gcode(stream, trace(stack(2), options), options)
    assert stream.getvalue() == ""


def test_a_centred_origin_is_not_shifted() -> None:
    printer = Printer().run(written(stack(1), bed_origin="centre")[0])
    assert printer.ends().min() == pytest.approx(-9.6)


def test_extrusion_that_would_overflow() -> None:
    long = np.array([[0.0, 0, 0.2], [100, 0, 0.2]])
    toolpath = Toolpath(
        long,
        np.full(2, EXTRUDE, np.int8),
        np.array([0.0, 3e5]),
        np.full(2, 10.0),
        np.zeros(2, np.int64),
        np.full(2, 2, np.int8),
        np.full((2, 2), np.nan),
    )
    stream = io.StringIO()
    with pytest.raises(SettingError, match="m of filament, more than the printer can count"):
        write_gcode(stream, [toolpath], wide())
    assert stream.getvalue() == ""


def test_a_part_larger_than_the_bed() -> None:
    bounds = np.array([[-115.0, -10, 0], [115, 10, 30]])
    with pytest.raises(SettingError, match=r"10.00 mm too large in x"):
        check_fits(bounds, wide())
    with pytest.raises(SettingError, match=r"30\.00 mm high"):
        check_fits(bounds / [2, 1, 1], wide(build_height=20))


def test_a_contour_printed_on_its_centre_needs_half_a_bead_on_either_side() -> None:
    settings = wide(contour="centre", bead_width=0.8)
    bed = np.array(settings.bed_size())
    fits = np.array([[-1.0, -1.0, 0.0], [1.0, 1.0, 1.0]])
    fits[:, :2] *= (bed - 0.8 - 1e-9) / 2
    check_fits(fits, settings)
    fits[1, 1] += 0.1
    with pytest.raises(SettingError, match=r"0.10 mm too large in y"):
        check_fits(fits, settings)


def test_no_feed_is_zero() -> None:
    """F0 stops some printers, and others take it for their last feed."""
    points = np.array([[0.0, 0, 0.2], [1, 0, 0.2]])
    toolpath = Toolpath(
        points,
        np.array([TRAVEL, EXTRUDE], np.int8),
        np.array([0.0, 0.1]),
        np.array([10.0, 0.001]),
        np.zeros(2, np.int64),
        np.array([0, 2], np.int8),
        np.full((2, 2), np.nan),
    )
    stream = io.StringIO()
    write_gcode(stream, [toolpath], wide())
    feeds = re.findall(r"^G[01].* F(\d+)$", stream.getvalue(), re.MULTILINE)
    assert feeds[-1] == "1"


@pytest.mark.parametrize(
    "name", ["print_speed", "travel_speed", "first_layer_speed", "z_speed", "retraction_speed"]
)
def test_speeds_of_zero_are_refused(name: str) -> None:
    with pytest.raises(SettingError, match=r"at least 0\.1 mm/s") as caught:
        PrintSettings(**{name: 0.0})  # type: ignore[arg-type]
    assert caught.value.name == name


def test_choices_are_checked() -> None:
    with pytest.raises(SettingError, match="seam spiral: give aligned or rear or scattered"):
        PrintSettings(seam="spiral")


def test_steps_too_short_to_be_told_keep_their_filament() -> None:
    count = 1000
    points = np.column_stack([np.arange(count) * 1e-4, np.zeros(count), np.full(count, 0.2)])
    toolpath = Toolpath(
        points,
        np.full(count, EXTRUDE, np.int8),
        np.full(count, 1e-3),
        np.full(count, 10.0),
        np.zeros(count, np.int64),
        np.full(count, 2, np.int8),
        np.full((count, 2), np.nan),
    )
    stream = io.StringIO()
    write_gcode(stream, [toolpath], wide())
    printer = Printer().run(stream.getvalue())
    assert len(printer.printing()) <= 101
    assert sum(m.extruded for m in printer.moves) == pytest.approx(1 / FILAMENT, abs=1e-2)


def test_layers_are_written_as_they_come(monkeypatch: pytest.MonkeyPatch) -> None:
    alive = 0
    most = 0

    def watched(paths: Iterator[Toolpath]) -> Iterator[Toolpath]:
        import weakref

        nonlocal alive, most

        def gone() -> None:
            nonlocal alive
            alive -= 1

        for path in paths:
            copy = Toolpath(*(getattr(path, name) + 0 for name in path.__dataclass_fields__))
            weakref.finalize(copy.points.base, gone)
            alive += 1
            most = max(most, alive)
            yield copy

    options = wide()
    write_gcode(io.StringIO(), watched(trace(stack(8), options)), options)
    assert most <= 3


numbers = st.integers(-(10**9), 10**9)


@given(st.lists(st.tuples(st.integers(0, 92), *[st.none() | numbers] * COLUMNS), max_size=30))
def test_lines_say_their_numbers(rows: list[tuple[int | None, ...]]) -> None:
    count = len(rows)
    said = np.array([[v is not None for v in row[1:]] for row in rows]).reshape(count, COLUMNS)
    words = np.array([[v or 0 for v in row[1:]] for row in rows]).reshape(count, COLUMNS)
    lines = Lines(
        np.array([row[0] for row in rows], dtype=np.int64),
        words.astype(np.int64),
        said.astype(bool),
        np.arange(count) % 2,
    )
    text = rendered(lines, [b"", b";remark\n"]).decode()
    found = text.replace(";remark\n", "").splitlines()
    assert text.count(";remark\n") == count // 2
    for row, line in itertools.zip_longest(rows, found):
        parts = [f"G{row[0]}"]
        for letter, value, decimals in zip("XYZIJEF", row[1:], DECIMALS.tolist(), strict=True):
            if value is not None:
                number = f"{value / 10**decimals:.{decimals}f}" if decimals else str(value)
                number = number.rstrip("0").rstrip(".") if decimals else number
                parts.append(letter + ("0" if number in ("-0", "") else number))
        assert line == " ".join(parts)


@pytest.mark.parametrize(
    ("seconds", "words"), [(5.4, "5s"), (65, "1m 5s"), (3600, "1h 0m 0s"), (90061, "1d 1h 1m 1s")]
)
def test_durations(seconds: float, words: str) -> None:
    assert duration_text(seconds) == words


@pytest.mark.parametrize("thesis", [False, True])
@pytest.mark.parametrize("arcs", [False, True])
def test_the_reader_agrees_with_the_writer(thesis: bool, arcs: bool, tmp_path: Path) -> None:
    layers = [layer(scattered(20, 10, 3), disc(14, 0.2 * k), k) for k in range(3)]
    text, totals = written(layers, thesis=thesis, arcs=arcs, retraction=1.0, end_gcode="")
    file = tmp_path / "a.gcode"
    file.write_text(text, encoding="utf-8")
    found = read_gcode(file)
    assert found.layers == 3
    assert found.filament_mm == pytest.approx(totals.filament_mm, abs=1e-4)
    assert found.time_s == pytest.approx(totals.time_s, rel=0.01)
    assert found.least == pytest.approx(totals.bounds[0], abs=0.01)
    assert found.greatest == pytest.approx(totals.bounds[1], abs=0.01)
    printer = Printer().run(text)
    assert found.extruded_mm == pytest.approx(sum(m.length for m in printer.printing()), rel=1e-4)


def seconds_by_pygcodedecode(text: str, settings: PrintSettings, folder: Path) -> float:
    """From the first move at the part to the last: it counts neither homing nor the end block."""
    interpreter = pytest.importorskip("pyGCodeDecode.gcode_interpreter")
    body = text[text.index("G0 X") : text.index("M73 P100")]
    file, presets = folder / "a.gcode", folder / "printer.yaml"
    file.write_text(f"G21\nG90\nM82\nG92 E0\n{body}", encoding="utf-8")
    presets.write_text(
        f"test:\n  nozzle_diam: {settings.nozzle_diameter}\n  filament_diam: 1.75\n"
        f"  p_vel: {settings.print_speed}\n  p_acc: {settings.acceleration}\n"
        f"  jerk: {settings.corner_speed}\n"
        "  vX: 500\n  vY: 500\n  vZ: 500\n  vE: 500\n  firmware: junction_deviation\n",
        encoding="utf-8",
    )
    setup = interpreter.setup(presets_file=presets, printer="test", verbosity_level=0)
    start = Printer().run(body).moves[0].stop
    setup.set_initial_position(dict(zip("XYZE", (*start, 0.0), strict=True)))
    simulation = interpreter.simulation(
        gcode_path=file, initial_machine_setup=setup, verbosity_level=0
    )
    return float(simulation.blocklist[-1].get_segments()[-1].t_end)


@pytest.mark.parametrize("thesis", [False, True])
def test_time_is_that_of_pygcodedecode(thesis: bool, tmp_path: Path) -> None:
    options = wide(
        print_speed=40.0,
        perimeter_speed=40.0,
        travel_speed=120.0,
        retraction=1.0,
        corner_speed=5.0,
    )
    text, totals = written_with(options, stack(3, 25), thesis=thesis)
    theirs = seconds_by_pygcodedecode(text, options, tmp_path)
    assert totals.time_s == pytest.approx(theirs, rel=0.05)


def test_time_of_a_part_by_default_is_that_of_pygcodedecode(samples: Path, tmp_path: Path) -> None:
    """With skins, foam, slow small layers, retraction, hop and wipe."""
    structure = v3dcad.fill(samples / "wedge.step", layer_height=0.2, cell_size=5)
    options = PrintSettings(z_hop=0.2, wipe=1.0, skirt_loops=0, prime_line=0.0)
    text, totals = written_with(options, list(structure.layers)[:12])
    assert totals.time_s > 60
    theirs = seconds_by_pygcodedecode(text, options, tmp_path)
    assert totals.time_s == pytest.approx(theirs, rel=0.01)


def test_retractions_are_in_the_file_as_traced() -> None:
    options = wide(retraction=0.8)
    paths = list(trace(stack(2, 20), options, thesis=True))
    pulled = sum(int(np.count_nonzero(path.kind == RETRACT)) for path in paths)
    text, _ = written(stack(2, 20), thesis=True, retraction=0.8, extrusion="relative")
    assert text.count("E-0.8") == pulled + 1 > 4  # once before the first layer


@pytest.mark.parametrize("pulled_by", ["gcode", "firmware"])
@pytest.mark.parametrize("extrusion", ["absolute", "relative"])
def test_filament_is_held_back_on_every_way_and_never_as_it_is_laid(
    extrusion: str, pulled_by: str
) -> None:
    """From the prime line on: the way from there to the first stroke is the longest."""
    text, _ = written(
        stack(2, 20), thesis=True, extrusion=extrusion, prime_line=100.0,
        retraction=0.8, retraction_by=pulled_by, retraction_travel=1.5,
    )  # fmt: skip
    held, last_e, ways = 0.0, 0.0, []
    here = np.zeros(2)
    for line in text[text.rindex("G92 E0\nG1 Z2") :].splitlines():
        words = {word[0]: word[1:] for word in line.partition(";")[0].split()}
        code = words.get("G")
        if code == "92":
            last_e = float(words["E"])
        elif code in ("10", "11"):
            held += 0.8 if code == "10" else -0.8
        elif code in ("0", "1"):
            there = np.array([float(words.get(a, b)) for a, b in zip("XY", here, strict=True)])
            fed = float(words.get("E", last_e if extrusion == "absolute" else 0))
            if extrusion == "absolute":
                fed, last_e = fed - last_e, fed
            if (there == here).all():
                held -= fed
            elif fed > 0:
                assert held == pytest.approx(0.0, abs=1e-9)
            elif (way := float(np.hypot(*(there - here)))) >= 1.5:
                assert held == pytest.approx(0.8)
                ways.append(way)
            here = there
    assert max(ways) > 60
    assert len(ways) > 4


ACCELERATIONS = {
    "acceleration": 1000.0,
    "perimeter_acceleration": 500.0,
    "solid_acceleration": 800.0,
    "bridge_acceleration": 800.0,
    "travel_acceleration": 2000.0,
}


@pytest.mark.parametrize("flavour", ["marlin", "klipper"])
def test_every_move_has_the_acceleration_of_its_feature(flavour: str) -> None:
    layers = [layer(scattered(12, 8, 1), square(8, z=0.2 * k), k) for k in range(3)]
    options = wide(wall_beads=2, flavour=flavour, bottom_layers=1, top_layers=1, open=False,
                   perimeters=2, **ACCELERATIONS)  # fmt: skip
    stream = io.StringIO()
    write_gcode(stream, trace(layers, options), options)
    wanted = {"WALL-OUTER": 500.0, "WALL-INNER": 1000.0, "FILL": 1000.0, "SKIN": 800.0}
    printing = travelling = 0.0
    feature, seen = "", set()
    for line in stream.getvalue().splitlines():
        if line.startswith(";TYPE:"):
            feature = line[6:]
        elif line.startswith("M204"):
            words = {word[0]: float(word[1:]) for word in line.split()[1:]}
            printing, travelling = words.get("P", printing), words.get("T", travelling)
        elif line.startswith("SET_VELOCITY_LIMIT"):
            printing = travelling = float(line.split("ACCEL=")[1].split()[0])
        elif feature and line.startswith("G1") and "E" in line and ("X" in line or "Y" in line):
            assert printing == wanted[feature]
            seen.add(feature)
        elif feature and line.startswith("G0"):
            assert travelling == 2000
    assert seen == set(wanted)


def test_the_reader_knows_accelerations_of_their_own(tmp_path: Path) -> None:
    layers = [layer(scattered(12, 8, 1), square(8, z=0.2 * k), k) for k in range(3)]
    options = wide(wall_beads=2, open=False, **ACCELERATIONS)
    file = tmp_path / "print.gcode"
    with file.open("w") as stream:
        told = write_gcode(stream, trace(layers, options), options).time_s
    assert read_gcode(file, wide()).time_s == pytest.approx(told, rel=0.02)


@pytest.mark.parametrize(
    ("flavour", "line"),
    [
        ("marlin", "M900 K0.05"),
        ("reprapfirmware", "M572 D0 S0.05"),
        ("klipper", "SET_PRESSURE_ADVANCE ADVANCE=0.05"),
    ],
)
def test_pressure_advance_in_the_firmwares_words(flavour: str, line: str) -> None:
    layers = [layer(scattered(5, 8, 1), square(8))]
    assert line in written(layers, flavour=flavour, pressure_advance=0.05)[0].splitlines()
    assert line.split()[0] not in written(layers, flavour=flavour)[0]


def test_the_first_layer_may_be_hotter() -> None:
    """The start block waits for it; the others' temperatures are set when the second begins."""
    layers = stack(3, 5)
    blocks = {
        "start_gcode": "M140 S{bed_temperature}\nM109 S{nozzle_temperature}",
        "end_gcode": "; {nozzle_temperature} {bed_temperature}",
        "nozzle_temperature": 205.0,
        "bed_temperature": 60.0,
    }

    def told(**settings: float) -> list[str]:
        text = written(layers, **blocks, **settings)[0]
        assert text.splitlines()[-1] == "; 205 60"
        return [
            line for line in text.splitlines() if line[:5] in ("M140 ", "M104 ", "M109 ", ";LAYE")
        ]

    opened = [";LAYER_COUNT:3", ";LAYER:0", ";LAYER:1"]
    both = told(first_layer_hotter=5.0, first_layer_bed_hotter=-10.0)
    assert both == ["M140 S50", "M109 S210", *opened, "M104 S205", "M140 S60", ";LAYER:2"]
    nozzle = told(first_layer_hotter=5.0)
    assert nozzle == ["M140 S60", "M109 S210", *opened, "M104 S205", ";LAYER:2"]
    assert told(first_layer_hotter=0.0) == ["M140 S60", "M109 S205", *opened, ";LAYER:2"]


def test_what_is_not_heated_is_not_heated_on_the_first_layer() -> None:
    cold = PrintSettings(bed_temperature=0.0, nozzle_temperature=0.0, first_layer_bed_hotter=5.0)
    assert cold.first_layer_temperatures() == (0.0, 0.0)


@pytest.mark.parametrize(("flavour", "how"), [("klipper", "M83"), ("marlin", "M82")])
def test_arcs_in_klipper_count_from_the_move_before(flavour: str, how: str) -> None:
    text = written([layer(scattered(5, 8, 1), disc(8))], flavour=flavour, arcs=True)[0]
    assert how in text.splitlines()
