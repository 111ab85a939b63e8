"""Draw the pictures of docs/foam.md and docs/grading.md: `python docs/pictures.py`.

The same bytes each time. A vertical cut shows where the walls, which are plane polygons in space,
cross the plane y = 0.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

import v3dcad
from v3dcad.fields.expression import ramp
from v3dcad.model import Floats
from v3dcad.settings import Field
from v3dcad.view.colours import BLUE, RAMP, VERMILLION

HERE = Path(__file__).resolve().parent
SIDE, HEIGHT = 40.0, 60.0
"""The pole that is cut, mm."""


FINE, COARSE = 2.0, 6.0
"""The sizes of cells that differ in size, mm."""

GRADED: dict[str, Field] = {
    "sideways": lambda x, y, z: ramp(x, -15, 5, FINE, COARSE),
    "upward": lambda x, y, z: ramp(z, 10, 50, FINE, COARSE),
    "away from the middle": lambda x, y, z: ramp(np.hypot(x, y), 4, 18, FINE, COARSE),
    "waves": lambda x, y, z: 4 + 2 * np.sin(x / 6 + z / 10) * np.cos(y / 7 - z / 8),
    "a step, 10 mm under the top": lambda x, y, z: np.where(z > HEIGHT - 10, FINE, COARSE),
}
"""What sizes are asked for in each cut of docs/grading.md."""


def pole(**settings: object) -> v3dcad.Structure:
    """A square pole filled with cells of 6 mm, if nothing else is said."""
    low, high = np.array([[-SIDE / 2, -SIDE / 2, 0.0], [SIDE / 2, SIDE / 2, HEIGHT]])
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    triangles = [row for a, b, c, d in sides for row in ((a, b, c), (a, c, d))]
    mesh = (low + corners * (high - low), np.array(triangles))
    return v3dcad.fill(mesh, layer_height=HEIGHT / 2, **{"cell_size": 6.0, **settings})


def vertical_cut(structure: v3dcad.Structure) -> Floats:
    """Where the walls cross the plane y = 0: segments (s, 2, 2) in x and z, mm."""
    walls = structure.filling.space(0.0, HEIGHT).walls()
    following = np.arange(1, len(walls.points) + 1)
    following[walls.starts[1:] - 1] = walls.starts[:-1]
    a, b = walls.points, walls.points[following]
    crosses = (a[:, 1] > 0) != (b[:, 1] > 0)
    share = a[crosses, 1] / (a[crosses, 1] - b[crosses, 1])
    points = a[crosses] + share[:, None] * (b[crosses] - a[crosses])
    # A wall is convex: the plane crosses its outline twice.
    return points[:, [0, 2]].reshape(-1, 2, 2)


def section(structure: v3dcad.Structure, z: float) -> Floats:
    """The walls in the section at a height: segments (s, 2, 2) in x and y, mm."""
    diagram = structure.at(z)
    return np.asarray(diagram.vertices[diagram.edges[diagram.inner()]])


def panel(axes: Axes, segments: Floats, low: tuple[float, float], title: str) -> None:
    """Draw segments inside a frame that begins at `low` and ends at its opposite."""
    x, y = low
    width, height = SIDE, SIDE if y else HEIGHT
    axes.fill(
        [x, x + width, x + width, x], [y, y, y + height, y + height], "#f3f7f8", ec=VERMILLION
    )
    axes.add_collection(LineCollection(list(segments), colors=BLUE, linewidths=1.3))
    axes.set(xlim=(x - 1, x + width + 1), ylim=(y - 1, y + height + 1), aspect="equal")
    axes.set_axis_off()
    axes.set_title(title, fontsize=9)


def write(name: str, panels: list[tuple[Floats, tuple[float, float], str]], size: float) -> None:
    """Write panels beside each other as a PNG."""
    figure = Figure(figsize=(2.6 * len(panels), size), dpi=110, layout="constrained")
    for axes, shown in zip(np.atleast_1d(figure.subplots(1, len(panels))), panels, strict=True):
        panel(axes, *shown)
    figure.savefig(HERE / name, metadata={"Software": None})


def write_graded(name: str) -> None:
    """Write vertical cuts of foams of many sizes, cells in the colour of the size asked for at
    their sites.
    """
    figure = Figure(figsize=(2.0 * len(GRADED) + 0.8, 3.8), dpi=110, layout="constrained")
    panels = figure.subplots(1, len(GRADED))
    x, z = np.meshgrid(np.linspace(-SIDE / 2, SIDE / 2, 400), np.linspace(0, HEIGHT, 600))
    points = np.column_stack([x.ravel(), np.zeros(x.size), z.ravel()])
    colours = LinearSegmentedColormap.from_list("sizes", RAMP)
    for axes, (title, field) in zip(panels, GRADED.items(), strict=True):
        made = pole(cell_size=field)
        panel(axes, vertical_cut(made), (-SIDE / 2, 0.0), title)
        sizes = field(*made.filling.sites.T)[made.filling.foam.nearest(points)].reshape(x.shape)
        shown = axes.imshow(
            sizes, colours, vmin=FINE, vmax=COARSE, alpha=0.6, zorder=1.5, origin="lower",
            extent=(-SIDE / 2, SIDE / 2, 0, HEIGHT), aspect="equal",
        )  # fmt: skip
    figure.colorbar(shown, ax=panels, label="size asked for, mm", shrink=0.7)
    figure.savefig(HERE / name, metadata={"Software": None})


def main() -> None:
    """Draw all pictures."""
    write_graded("graded-cuts.png")
    upright, across = (-SIDE / 2, 0.0), (-SIDE / 2, -SIDE / 2)
    foam, columns = pole(), pole(stretch="columns")
    write(
        "columns-and-foam.png",
        [
            (vertical_cut(columns), upright, "columns, vertical cut"),
            (vertical_cut(foam), upright, "foam, vertical cut"),
            (section(columns, 20), across, "columns, section"),
            (section(foam, 20), across, "foam, section"),
        ],
        4.0,
    )
    heights = (20.0, 21.5, 23.0, 24.5)
    write(
        "foam-sections.png",
        [(section(foam, z), across, f"z = {z:g} mm") for z in heights],
        2.9,
    )
    angles = [(angle, pole(max_overhang=angle)) for angle in (30.0, 45.0, 60.0)]
    write(
        "foam-cuts.png",
        [
            (vertical_cut(made), upright, f"{angle:g}°: stretch {made.settings.stretch:.2f}")
            for angle, made in angles
        ],
        4.2,
    )


if __name__ == "__main__":
    main()
