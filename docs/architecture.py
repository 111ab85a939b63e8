"""Draw docs/architecture.svg: the path of the data, the rooms, and who knows whom.

python docs/architecture.py

Arrows are the imports of the source, what each room is for is the first sentence of its docstring;
only the places are chosen here. Where an arrow follows from others it is left out: a room may know
all that its arrows lead to. Everybody knows the rooms at the bottom. A file or folder of v3dcad/
that has no place in the picture is an error.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from html import escape
from pathlib import Path
from textwrap import wrap

ROOT = Path(__file__).resolve().parent.parent
PICTURE = ROOT / "docs" / "architecture.svg"

WIDTH, HEIGHT = 1158, 1096
COLUMN, GAP, LEFT = 178, 10, 20
"""Boxes stand in six columns."""

LETTER = 6.1
"""How wide a letter is taken to be, whatever the font of whoever looks at the picture"""

LEGEND = (
    "Red: the way of the data. Grey: who knows whom, as the files import each other; what follows "
    "from other arrows is left out."
)

STYLE = """
text { font: 11px system-ui, sans-serif; fill: #24323a }
.name { font: 600 13px ui-monospace, monospace }
.stage { font: 600 14px system-ui, sans-serif; fill: #fff }
.on { fill: #fff }
.paper { fill: #fff }
.frame { fill: #f1f5f7; stroke: none }
.room { fill: #fff; stroke: #8fa5b0 }
.chip { fill: #1f6f8b; stroke: none }
.knows { fill: none; stroke: #8fa5b0; stroke-width: 1.3; marker-end: url(#tip) }
.flow { fill: none; stroke: #d1495b; stroke-width: 2.6; marker-end: url(#drop) }
.tip { fill: #8fa5b0 }
.drop { fill: #d1495b }
@media (prefers-color-scheme: dark) {
  text { fill: #d9e2e7 }
  .stage, .on { fill: #fff }
  .paper { fill: #0f171b }
  .frame { fill: #18232a }
  .room { fill: #0f171b; stroke: #56707d }
  .chip { fill: #1b6078 }
  .knows { stroke: #6f8895 }
  .tip { fill: #6f8895 }
  .flow { stroke: #e8707f }
  .drop { fill: #e8707f }
}
"""


@dataclass(frozen=True)
class Room:
    """A box of the picture: some modules, the docstring that tells of them, and a place."""

    title: str
    modules: tuple[str, ...]
    """paths below v3dcad/: files, or folders with all in them that has no place of its own"""
    column: int
    y: int
    columns: int = 1
    height: int = 84

    @property
    def x(self) -> int:
        """The left side."""
        return LEFT + self.column * (COLUMN + GAP)

    @property
    def width(self) -> int:
        """From the left side to the right one."""
        return self.columns * COLUMN + (self.columns - 1) * GAP

    @property
    def middle(self) -> float:
        """Half-way between left and right."""
        return self.x + self.width / 2


ROOMS = (
    Room("cli.py, commands/", ("commands", "cli", "__main__", "options"), 0, 20, 2, 56),
    Room("worker/", ("worker",), 2, 20, 2, 56),
    Room("adapters/", ("adapters",), 4, 20, 2, 56),
    Room(
        "pipeline.py",
        (
            "pipeline", "cell_size", "exports", "files", "forms", "limits", "nearness", "notes",
            "ont", "pages", "parts", "recipes", "report", "signatures", "slicing", "sources",
            "version", "views", "warm_up", "watched", "__init__",
        ),
        0, 112, 5, 178,
    ),
    Room("printer/", ("printer",), 5, 112, 1, 178),
    Room("kernel/", ("kernel",), 0, 332),
    Room("fields/", ("fields",), 1, 332),
    Room("structure/", ("structure",), 2, 332),
    Room("toolpath/", ("toolpath",), 3, 332),
    Room("formats/", ("formats",), 4, 332),
    Room("view/", ("view",), 5, 332),
    Room("surface/", ("geometry/surface",), 0, 484, 1, 100),
    Room("solid/", ("geometry/solid",), 1, 484, 1, 100),
    Room("graphs/", ("geometry/graphs",), 3, 484, 1, 100),
    Room("*.py", ("geometry",), 5, 484, 1, 100),
    Room("mesh/", ("geometry/mesh",), 0, 628, 2, 100),
    Room("clipping/", ("geometry/clipping",), 2, 628, 1, 100),
    Room("voronoi/", ("geometry/voronoi",), 3, 628, 1, 100),
    Room("power_diagram/", ("geometry/power_diagram",), 2, 766, 1, 100),
    Room("compiled/", ("geometry/compiled",), 0, 904, 6, 46),
    Room("model.py", ("model", "svg", "words"), 0, 1002, 2, 56),
    Room("settings.py", ("settings", "arguments"), 2, 1002, 2, 56),
    Room("errors.py", ("errors",), 4, 1002, 2, 56),
)  # fmt: skip

KNOWN_TO_ALL = ("model", "settings", "errors", "words")

STAGES = (
    ("Part", "file, shape or mesh", 0, 0),
    ("Sections", "rings at each height", 1, 0),
    ("Structure", "a diagram in each", 2, 0),
    ("Toolpath", "what the nozzle does", 3, 0),
    ("G-code", "moves as text", 4, 0),
    ("Printer", "", 5, 0),
    ("B-rep, .ont", "STEP, 3MF, STL, PNG", 4, 1),
)
"""Name, what it is, column and line of what flows through the main path."""

FLOW = ((0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (2, 6))
"""Which stage becomes which."""


def room_of(module: str) -> str:
    """The first module of the room that a module, as a path below v3dcad/, has its place in."""
    words = module.split("/")
    for count in range(len(words), 0, -1):
        for room in ROOMS:
            if "/".join(words[:count]) in room.modules:
                return room.modules[0]
    raise SystemExit(f"v3dcad/{module} has no place in docs/architecture.svg: give it one in ROOMS")


def knowledge(package: Path) -> dict[str, set[str]]:
    """Which rooms each room imports from, by the source of a package."""
    known: dict[str, set[str]] = {room.modules[0]: set() for room in ROOMS}
    for path in sorted(package.rglob("*.py")):
        here = path.relative_to(package).with_suffix("").as_posix()
        own = room_of(here.removesuffix("/__init__"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("v3dcad."):
                known[own].add(room_of(node.module.removeprefix("v3dcad.").replace(".", "/")))
        known[own].discard(own)
    return known


def arrows(known: dict[str, set[str]]) -> list[tuple[str, str]]:
    """Who knows whom, but what follows from other arrows, and the rooms known to all."""

    def follows(room: str, other: str) -> bool:
        """Whether a room knows another by way of a third."""
        reached: set[str] = set()
        waiting = known[room] - {other}
        while waiting:
            reached |= waiting
            waiting = set().union(*(known[between] for between in waiting)) - reached
        return other in reached

    return [
        (room, other)
        for room in known
        for other in known
        if other in known[room] and other not in KNOWN_TO_ALL and not follows(room, other)
    ]


def sentence(package: Path, module: str) -> str:
    """The first sentence of a module's or a folder's docstring."""
    path = package / module
    source = (path / "__init__.py" if path.is_dir() else path.with_suffix(".py")).read_text("utf-8")
    told = ast.get_docstring(ast.parse(source)) or ""
    first = re.split(r"(?<=[.;])\s|\n\n", told, maxsplit=1)[0]
    return " ".join(first.split()).rstrip(".;").replace("`", "")


def text(x: float, y: float, words: str, style: str = "", anchor: str = "") -> str:
    """One line of text."""
    extra = (f' class="{style}"' if style else "") + (f' text-anchor="{anchor}"' if anchor else "")
    return f'<text x="{x:g}" y="{y:g}"{extra}>{escape(words, quote=False)}</text>'


def box(x: float, y: float, width: float, height: float, style: str) -> str:
    """A box with round corners."""
    return f'<rect class="{style}" x="{x}" y="{y}" width="{width}" height="{height}" rx="6"/>'


def drawn_room(room: Room, package: Path) -> list[str]:
    """The box of a room: its name, and what it is for."""
    path = package / room.modules[0]
    files = ", ".join(file.stem for file in sorted(path.glob("[a-z]*.py")))
    told = files if room.title == "*.py" else sentence(package, room.modules[0])
    lines = wrap(told, int((room.width - 18) / LETTER))
    return [
        box(room.x, room.y, room.width, room.height, "room"),
        text(room.x + 9, room.y + 19, room.title, "name"),
        *(text(room.x + 9, room.y + 35 + 13.5 * k, line) for k, line in enumerate(lines)),
    ]


def frame(rooms: list[Room]) -> str:
    """What lies behind some rooms that belong together."""
    top = min(room.y for room in rooms) - 34
    bottom = max(room.y + room.height for room in rooms) + 10
    return box(LEFT - 10, top, WIDTH - 2 * LEFT + 20, bottom - top, "frame")


def drawn_arrows(pairs: list[tuple[str, str]]) -> list[str]:
    """A line from the bottom of each room that knows another to the top of that one.

    Straight down where one lies above the other. Else from the side that is nearer to the side that
    is nearer: down to the row above the other's, then over.
    """
    by_name = {room.modules[0]: room for room in ROOMS}
    taken: dict[tuple[str, str, bool], int] = {}

    def port(room: Room, end: str, other: Room) -> float:
        """Where a line meets the bottom or the top of a room, the next ones farther inside."""
        right = other.middle > room.middle
        place = taken[room.title, end, right] = taken.get((room.title, end, right), 0) + 1
        return room.x + room.width - 14 * place if right else room.x + 14 * place

    curves = []

    def apart(pair: tuple[str, str]) -> float:
        return abs(by_name[pair[0]].middle - by_name[pair[1]].middle)

    for source, target in sorted(pairs, key=apart, reverse=True):
        above, below = by_name[source], by_name[target]
        start, stop = above.y + above.height, below.y - 7
        narrow, wide = sorted((above, below), key=lambda room: room.width)
        if wide.x <= narrow.middle <= wide.x + wide.width:
            curves.append(f'<path class="knows" d="M{narrow.middle:g} {start}V{stop}"/>')
            continue
        x0, x1 = port(above, "bottom", below), port(below, "top", above)
        over = max(room.y + room.height for room in ROOMS if room.y + room.height < stop)
        bend = (stop - over) * 0.7
        curves.append(
            f'<path class="knows" d="M{x0:g} {start}V{over}C{x0:g} {over + bend:g} '
            f'{x1:g} {stop - bend:g} {x1:g} {stop}"/>'
        )
    return curves


def drawn_stages(y: int) -> list[str]:
    """What flows through the main path, from left to right."""
    drawn = []
    places = []
    for name, what, column, line in STAGES:
        x, top = LEFT + 20 + column * (COLUMN + GAP), y + 56 * line
        places.append((x, top))
        drawn += [
            box(x, top, COLUMN - 40, 46, "chip"),
            text(x + (COLUMN - 40) / 2, top + (20 if what else 28), name, "stage", "middle"),
        ]
        if what:
            drawn.append(text(x + (COLUMN - 40) / 2, top + 36, what, "on", "middle"))
    for one, other in FLOW:
        (x0, y0), (x1, y1) = places[one], places[other]
        if y0 == y1:
            drawn.append(f'<path class="flow" d="M{x0 + COLUMN - 40} {y0 + 23}H{x1 - 9}"/>')
        else:
            middle = x0 + (COLUMN - 40) / 2
            drawn.append(
                f'<path class="flow" d="M{middle} {y0 + 46}V{y1 + 13}'
                f'Q{middle} {y1 + 23} {middle + 10} {y1 + 23}H{x1 - 9}"/>'
            )
    return drawn


def picture(package: Path = ROOT / "v3dcad") -> str:
    """The whole drawing of a package as SVG."""
    path = next(room for room in ROOMS if room.modules[0] == "pipeline")
    beside = ", ".join(name for name in path.modules[1:] if name != "__init__")
    inner = [room for room in ROOMS if room.modules[0].startswith("geometry")]
    aside = next(room for room in inner if room.modules == ("geometry/voronoi",))
    base = [room for room in ROOMS if room.modules[0] in KNOWN_TO_ALL]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
            f'width="{WIDTH}" height="{HEIGHT}">',
            "<title>How v3dcad is laid out</title>",
            f"<style>{STYLE}</style>",
            *(
                f'<marker id="{name}" viewBox="0 0 8 8" refX="1" refY="4" markerWidth="{size}" '
                f'markerHeight="{size}" markerUnits="userSpaceOnUse" orient="auto">'
                f'<path class="{name}" d="M0 0L8 4L0 8z"/></marker>'
                for name, size in (("tip", 8), ("drop", 10))
            ),
            f'<rect class="paper" width="{WIDTH}" height="{HEIGHT}"/>',
            frame(inner),
            frame(base),
            text(aside.middle + 24, aside.y + 178, "geometry/", "name"),
            text(aside.middle + 24, aside.y + 196, sentence(package, "geometry")),
            text(LEFT + 1, base[0].y - 12, "known to all", "name"),
            *(line for room in ROOMS for line in drawn_room(room, package)),
            text(path.x + 9, path.y + path.height - 12, f"beside it: {beside}"),
            *drawn_stages(path.y + 50),
            *drawn_arrows(arrows(knowledge(package))),
            text(LEFT + 1, HEIGHT - 14, LEGEND),
            "</svg>",
            "",
        ]
    )


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8", newline="\n")
