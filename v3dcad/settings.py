"""Every setting, declared once: name, unit, range, default, help.

The command line's options, the `.ont` file, the workbench's properties and the
documentation are all made from these classes. Imports nothing heavy, so that
`v3dcad --help` stays quick.
"""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from numbers import Integral, Real
from typing import Any, TypeVar, get_args, get_type_hints

from v3dcad.errors import SettingError

T = TypeVar("T")

Field = Callable[[Any, Any, Any], Any]
"""What differs from place to place: values (n,) at x, y and z (n,), mm, where the source lies."""


LEAST_PITCH = 4.0
"""Bead widths between ribs, which are two beads wide: nearer ones would leave nothing to span."""

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "inch": 25.4, "foot": 304.8}
"""Units that the coordinates of a file may be counted in, mm."""


@dataclass(frozen=True, slots=True)
class Declared:
    """What is known of one setting besides its type and default."""

    help: str
    unit: str = ""
    metavar: str | None = None
    above: float = -math.inf
    least: float = -math.inf
    most: float = math.inf
    choices: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    """words that may take a number's place"""
    fields: bool = False
    """whether a function of x, y, z may, or an expression of them"""
    also: tuple[float, ...] = ()
    """numbers that are allowed outside the range"""
    share: bool = False
    """whether it is a share, which may be written in percent: "15%" is 0.15"""
    method: str | None = None
    """the method that it is a setting of; None: of all"""

    def checked(self, name: str, value: Any, kinds: tuple[Any, ...] = (float,)) -> Any:
        """The value as Python's own type, of which NumPy's scalars are made too.

        Raises `SettingError` unless it is of one of the kinds (bool, int, float, str), and is a
        declared choice or word, or lies in the range.
        """
        value = _python_value(value)
        if self.choices or (str in kinds and not self.words):
            if not isinstance(value, str) or value not in (self.choices or (value,)):
                wanted = " or ".join(self.choices) or "text"
                raise SettingError(name, f"{option(name)} {value}: give {wanted}")
            return value
        if bool in kinds:
            if not isinstance(value, bool):
                raise SettingError(name, f"{option(name)} {value!r}: give True or False")
            return value
        if isinstance(value, str) and (value in self.words or self.fields):
            return value
        if isinstance(value, str) and self.share:
            value = _share(value)
        if self.fields and callable(value):
            return value
        kind: Any = Real if float in kinds else Integral
        if isinstance(value, bool) or not isinstance(value, kind):
            number = "a number" if kind is Real else "a whole number"
            words = " or ".join([number, *self.words])
            raise SettingError(name, f"{option(name)} {value!r}: give {words}")
        if not isinstance(value, (int, float)):
            value = float(value)  # a fraction
        self._check_range(name, value)
        return value

    def _check_range(self, name: str, value: float) -> None:
        """Raise `SettingError` unless a number lies in the range."""
        unit = f" {self.unit}" if self.unit else ""
        largest = sys.float_info.max
        if not -largest <= value <= largest:
            raise SettingError(name, f"{option(name)} {value}: give a finite number{unit}")
        if value in self.also:
            return
        if value <= self.above:
            raise SettingError(
                name, f"{option(name)} {value}: give a number above {self.above:g}{unit}"
            )
        if value < self.least:
            raise SettingError(
                name, f"{option(name)} {value}: give a number of at least {self.least:g}{unit}"
            )
        if value > self.most:
            percent = f", which is {100 * self.most:g}%" if self.share else ""
            raise SettingError(
                name,
                f"{option(name)} {value}: give a number of at most {self.most:g}{unit}{percent}",
            )


def option(name: str) -> str:
    """The setting's name as it is written on the command line."""
    return "--" + name.replace("_", "-")


def setting(default: T, help: str, **declared: Any) -> T:
    """A dataclass field that carries its declaration."""
    field: T = dataclasses.field(
        default=default, metadata={"declared": Declared(help=help, **declared)}
    )
    return field


def declared(cls: type[Checked], name: str) -> Declared:
    """The declaration of one field of a settings class."""
    found: Declared = cls.__dataclass_fields__[name].metadata["declared"]
    return found


class Checked:
    """A settings class: values are checked against their declarations on construction."""

    __slots__ = ()
    __dataclass_fields__: dict[str, dataclasses.Field[Any]]

    def __post_init__(self) -> None:
        for name in self.__dataclass_fields__:
            object.__setattr__(self, name, checked(type(self), name, getattr(self, name)))


def checked(cls: Any, name: str, value: Any) -> Any:
    """A value of one field of a settings class, as `Declared.checked` has it."""
    return declared(cls, name).checked(name, value, _kinds(cls)[name])


@cache
def _kinds(cls: Any) -> dict[str, tuple[Any, ...]]:
    """The types that each setting of a class may have."""
    hints = get_type_hints(cls)
    return {name: get_args(hints[name]) or (hints[name],) for name in cls.__dataclass_fields__}


def _share(text: str) -> float | str:
    """The share that a text says in percent; the text where it says none."""
    try:
        return float(text.strip().removesuffix("%")) / 100 if text.strip().endswith("%") else text
    except ValueError:
        return text


def _python_value(value: Any) -> Any:
    """A value as Python has it where it is a NumPy scalar; `.ont` and JSON know no others."""
    return value.item() if getattr(value, "shape", None) == () else value


@dataclass(frozen=True, kw_only=True, slots=True)
class SectionSettings(Checked):
    """How a part is cut into sections."""

    layer_height: float = setting(0.2, "Distance between two layers.", unit="mm", above=0)
    chord_tolerance: float = setting(
        0.005,
        "How far straight pieces of a contour may lie from a curved surface.",
        unit="mm",
        above=0,
    )
    base_clearance: float = setting(
        0.0,
        "How far the part's base lies below the first layer; 0.1 in the thesis.",
        unit="mm",
        least=0,
    )


SIZING = ("cell_size", "density", "mass")
"""Settings of a fill that say how large cells are; one of them does."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FillSettings(SectionSettings):
    """How a part is filled."""

    method: str = setting(
        "foam",
        "What the part is filled with: a foam of cells in space, or the thesis's own structure.",
        choices=("foam", "thesis"),
    )
    cell_size: float | str | Field = setting(
        "auto",
        "Size of the cells: a horizontal section has one for each square of this side; auto takes "
        "40 in the base rectangle, from 3 to 15 mm. An expression of x, y, z makes it differ from "
        "place to place.",
        unit="mm",
        above=0,
        words=("auto",),
        fields=True,
        method="foam",
    )
    density: float | str = setting(
        "off",
        "Share of the part's volume that is printed: walls, perimeters and skins as the print "
        "settings make them. Cells get the size that it takes. 0.15 or 15%.",
        above=0,
        most=1,
        words=("off",),
        share=True,
        method="foam",
    )
    mass: float | str = setting(
        "off",
        "What the printed part weighs, brim and skirt left out. Cells get the size that it takes.",
        unit="g",
        above=0,
        words=("off",),
        method="foam",
    )
    roof_size: float | str = setting(
        "off",
        "Largest span of a skin over cells: under roofs no cell is wider. The .ont file then lists "
        "all sites.",
        unit="mm",
        above=0,
        words=("off",),
        method="foam",
    )
    stretch: float | str = setting(
        "auto",
        "How many times as tall as wide cells are, about; auto takes the least that --max-overhang "
        "allows. columns makes upright walls.",
        least=1,
        most=100,
        words=("auto", "columns"),
        method="foam",
    )
    heights: str = setting(
        "middle",
        "Where a layer's section is taken: in the middle of the bead that fills it, or at its "
        "bottom, as the thesis does.",
        choices=("middle", "bottom"),
        method="foam",
    )
    strict: bool = setting(
        False,
        "Refuse a cell size that changes more steeply than cells can follow, instead of making "
        "them smaller there.",
        method="foam",
    )
    max_overhang: float = setting(
        45.0,
        "Largest tilt of a wall from the vertical, 10 to 80; 90 allows any.",
        unit="°",
        least=10,
        most=80,
        also=(90.0,),
    )
    random_seed: int = setting(
        0, "Another number gives other cells of the same kind.", least=0, most=2**63 - 1
    )
    sites: int = setting(
        40,
        "Number of sites, scattered evenly in the base rectangle.",
        least=1,
        most=200_000,
        method="thesis",
    )
    offset: float | str = setting(
        "auto",
        "Weight that a growing cell gains in each layer; auto takes the largest that "
        "--max-overhang allows (at 90, what 45 would).",
        unit="mm²",
        least=0,
        words=("auto",),
        method="thesis",
    )
    insertion: bool = setting(
        True, "New cells come in where cells have become too large.", method="thesis"
    )
    interpolate: bool = setting(
        False,
        "Compute the first and last layer only and loft between them, cell by cell.",
        method="thesis",
    )
    boundary_tolerance: float = setting(
        0.01,
        "How close to the contour a corner counts as on it.",
        unit="mm",
        above=0,
        method="thesis",
    )
    weight_step: float = setting(
        0.0,
        "Steps in which an inserted cell's weight is lowered; 0 for the offset.",
        unit="mm²",
        least=0,
        method="thesis",
    )

    def __post_init__(self) -> None:
        Checked.__post_init__(self)
        for name, field in FillSettings.__dataclass_fields__.items():
            if getattr(self, name) != field.default:
                self.refuse_other(name, self.method)
        given = [name for name in SIZING if getattr(self, name) not in ("auto", "off")]
        if len(given) > 1:
            raise SettingError(
                given[1],
                f"{option(given[1])}: {option(given[0])} says how large cells are, too; leave one "
                "of the two out",
            )

    def wish(self) -> tuple[str, float] | None:
        """The setting that a cell size is to be found for, density or mass, and its number."""
        for name in SIZING[1:]:
            if getattr(self, name) != "off":
                return name, float(getattr(self, name))
        return None

    def section_above(self) -> float:
        """How far above a layer's base its section is taken, mm."""
        middle = self.method == "foam" and self.heights == "middle"
        return self.layer_height / 2 if middle else 0.0

    def layer_span(self) -> tuple[float, float]:
        """How high a layer is, and where it begins: so far over its section (below it), mm."""
        return self.layer_height, -self.section_above()

    @property
    def lofts(self) -> bool:
        """Whether only the first and the last layer are computed, and those between lofted."""
        return self.method == "thesis" and self.interpolate

    @staticmethod
    def refuse_other(name: str, method: str) -> None:
        """Raise `SettingError` for a setting that belongs to another method."""
        own = declared(FillSettings, name).method
        if own not in (None, method):
            raise SettingError(
                name,
                f"{option(name)} is a setting of --method {own}, not of {method}: leave it out, or "
                "choose that method",
            )


START = """\
G21 ; millimetres
G90 ; absolute positions
M140 S{bed_temperature}
M104 S{nozzle_temperature}
G28 ; home
M190 S{bed_temperature}
M109 S{nozzle_temperature}
"""

END = """\
G91
G1 Z10 F600 ; clear of the part
G90
G28 X Y
M104 S0
M140 S0
M107
M84
"""


def _acceleration(what: str) -> Any:
    """A setting for the acceleration of one kind of beads."""
    return setting(
        "same",
        f"Acceleration while extruding {what}; same is that of cells.",
        unit="mm/s²",
        least=1,
        most=1_000_000,
        words=("same",),
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class PrintSettings(Checked):
    """How a structure is printed. The defaults are a stock Ender 3 with an 0.4 mm nozzle and PLA.

    A machine profile (`formats/gcode/machine_profile.py`) gives values for these same settings;
    `profiles/ender3v2.toml` says where the defaults come from.
    """

    machine: str = setting(
        "Creality Ender 3 family, 0.4 mm nozzle, PLA",
        "What the G-code is for, as its header says.",
    )
    nozzle_diameter: float = setting(0.4, "Diameter of the nozzle.", unit="mm", least=0.01, most=20)
    bead_width: float = setting(
        0.45,
        "Width of one extruded bead; a little more than the nozzle's diameter.",
        unit="mm",
        least=0.01,
        most=20,
    )
    bead_shape: str = setting(
        "rounded",
        "Cross-section of a bead: the thesis's rectangle, or rounded as slicers have it.",
        choices=("rectangle", "rounded"),
    )
    flow: float = setting(
        100.0, "Share of the computed material extruded.", unit="%", least=1, most=1000
    )
    first_layer_height: float = setting(
        0.2, "Height of the first layer's beads.", unit="mm", least=0.01, most=10
    )
    first_layer_speed: float = setting(
        20.0, "Speed while extruding the first layer.", unit="mm/s", least=0.1, most=2000
    )
    first_layer_flow: float = setting(
        100.0, "The same on the first layer, instead of `flow`.", unit="%", least=1, most=1000
    )
    minimum_edge: float = setting(
        0.1, "Edges shorter than this are joined to their neighbours.", unit="mm", least=0, most=2
    )

    contour: str = setting(
        "inset",
        "Print perimeters half a bead inside the contour, or with their centre on it as the "
        "thesis does.",
        choices=("inset", "centre"),
    )
    perimeters: int = setting(2, "Number of perimeters along each contour.", least=1, most=1000)
    perimeter_order: str = setting(
        "together",
        "Print the innermost perimeter in one stroke with the cells, or all perimeters before "
        "or after them.",
        choices=("together", "before", "after"),
    )
    wall_beads: int = setting(
        2,
        "Beads to a wall between cells: two, or one for light parts, where some walls are passed "
        "twice with half the plastic. Each region is one closed stroke.",
        least=1,
        most=2,
    )
    seam: str = setting(
        "aligned",
        "Where the outermost perimeter begins and ends, with two beads to a wall: above the seam "
        "below, else in the sharpest corner; at the rear; or somewhere else on each layer.",
        choices=("aligned", "rear", "scattered"),
    )
    bottom_layers: int = setting(
        4, "Solid layers over every face that looks down.", least=0, most=1000
    )
    top_layers: int = setting(4, "Solid layers under every face that looks up.", least=0, most=1000)
    skin_span: float | str = setting(
        5.0,
        "Longest span of a skin over cells: where cells are wider, ribs grow out of their walls "
        "under it.",
        unit="mm",
        least=2,
        words=("off",),
    )
    open: bool = setting(
        False, "Leave out all solid layers: walls and contours alone, as the thesis prints."
    )
    skirt_loops: int = setting(1, "Loops around the first layer.", least=0, most=1000)
    skirt_distance: float = setting(
        3.0, "Distance from the first layer, or its brim, to the skirt.", unit="mm", least=0
    )
    brim_width: float | str = setting(
        "auto",
        "Width of the brim around the first layer; auto takes 5 where the part touches the bed "
        "with less than 100 mm², or less than 10 mm wide.",
        unit="mm",
        least=0,
        most=1000,
        words=("auto",),
    )

    prime_line: float = setting(
        100.0,
        "Length of the line along the bed's left edge that fills the nozzle; 0 for none.",
        unit="mm",
        least=0,
        most=1000,
    )

    print_speed: float = setting(
        50.0, "Speed while extruding cells.", unit="mm/s", least=0.1, most=2000
    )
    perimeter_speed: float = setting(
        25.0, "Speed while extruding perimeters.", unit="mm/s", least=0.1, most=2000
    )
    solid_speed: float = setting(
        40.0, "Speed while extruding solid layers.", unit="mm/s", least=0.1, most=2000
    )
    bridge_speed: float = setting(
        25.0,
        "Speed over air and cells: of solid layers, and of walls that hang.",
        unit="mm/s",
        above=0,
        most=2000,
    )
    bridge_flow: float = setting(
        100.0,
        "The same over air and cells, instead of `flow`.",
        unit="%",
        above=0,
        most=1000,
    )
    travel_speed: float = setting(
        150.0, "Speed while not extruding.", unit="mm/s", least=0.1, most=2000
    )
    minimum_layer_time: float = setting(
        8.0,
        "Layers that would take less are printed slower, so that they can cool.",
        unit="s",
        least=0,
        most=3600,
    )
    slowest_speed: float = setting(
        10.0, "Lowest speed that a layer is slowed down to.", unit="mm/s", least=0.1, most=2000
    )
    most_speed: float = setting(
        500.0, "Highest speed of the machine in x and y.", unit="mm/s", least=0.1, most=2000
    )
    most_flow: float = setting(
        15.0,
        "Most filament that the nozzle melts; it limits speeds.",
        unit="mm³/s",
        least=0.01,
        most=1000,
    )
    z_speed: float = setting(10.0, "Speed of moves in z alone.", unit="mm/s", least=0.1, most=2000)
    acceleration: float = setting(
        500.0, "Acceleration while extruding cells.", unit="mm/s²", least=1, most=1_000_000
    )
    perimeter_acceleration: float | str = _acceleration("perimeters")
    solid_acceleration: float | str = _acceleration("solid layers")
    bridge_acceleration: float | str = _acceleration("solid layers over air and cells")
    travel_acceleration: float | str = _acceleration("nothing")
    corner_speed: float = setting(
        8.0, "Speed at which a right-angled corner is taken.", unit="mm/s", least=0, most=2000
    )

    filament_diameter: float = setting(
        1.75, "Diameter of the filament.", unit="mm", least=0.1, most=20
    )
    filament_density: float = setting(
        1.24, "Density of the filament; PLA's is 1.24.", unit="g/cm³", least=0.01, most=25
    )
    pressure_advance: float | str = setting(
        "off",
        "How far the filament is fed ahead when the speed rises: K of M900 (Marlin), S of M572 "
        "(RepRapFirmware), ADVANCE of Klipper; off leaves the printer's own.",
        unit="s",
        least=0,
        most=10,
        words=("off",),
    )
    retraction: float = setting(
        5.0, "Filament pulled back before a travel.", unit="mm", least=0, most=50
    )
    retraction_speed: float = setting(
        40.0, "Speed of the filament when it is pulled back.", unit="mm/s", least=0.1, most=2000
    )
    retraction_travel: float = setting(
        1.5, "Shorter travels are made without retraction.", unit="mm", least=0
    )
    retraction_by: str = setting(
        "gcode",
        "Who pulls the filament back: moves in the G-code, or the firmware (G10, G11).",
        choices=("gcode", "firmware"),
    )
    z_hop: float = setting(
        0.0, "Height the nozzle is raised by when it is retracted.", unit="mm", least=0, most=100
    )
    wipe: float = setting(
        0.0,
        "How far the nozzle first goes back over its bead when it is retracted, so that it leaves "
        "no drop.",
        unit="mm",
        least=0,
        most=100,
    )

    nozzle_temperature: float = setting(
        205.0, "Temperature of the nozzle.", unit="°C", least=0, most=500
    )
    bed_temperature: float = setting(60.0, "Temperature of the bed.", unit="°C", least=0, most=200)
    first_layer_hotter: float = setting(
        5.0, "How much hotter the nozzle is on the first layer.", unit="°C", least=-50, most=50
    )
    first_layer_bed_hotter: float = setting(
        0.0, "How much hotter the bed is on the first layer.", unit="°C", least=-50, most=50
    )
    fan: float = setting(100.0, "Power of the part's fan.", unit="%", least=0, most=100)
    bridge_fan: float = setting(
        100.0,
        "Power of the fan over air and cells.",
        unit="%",
        least=0,
        most=100,
    )
    fan_from_layer: int = setting(1, "First layer that the fan blows at.", least=0)
    fan_full_layer: int = setting(
        3, "Layer from which the fan has its full power; before, it speeds up evenly.", least=0
    )

    fail_over: float | str = setting(
        "off",
        "Print nothing, with exit code 2, where beads span more than this over air or cells.",
        unit="mm",
        least=0,
        words=("off",),
    )

    flavour: str = setting(
        "marlin",
        "The printer's firmware.",
        choices=("marlin", "reprapfirmware", "klipper"),
    )
    extrusion: str = setting(
        "absolute",
        "Count filament from the layer's start, or from the move before.",
        choices=("absolute", "relative"),
    )
    arcs: bool = setting(False, "Write perimeters that are circular arcs as G2 and G3.")
    bed: str = setting("220x220", "Width and depth of the bed.", unit="mm", metavar="WIDTHxDEPTH")
    build_height: float = setting(250.0, "Height that the printer can build.", unit="mm", above=0)
    bed_origin: str = setting(
        "corner", "Where the printer's x and y are 0.", choices=("corner", "centre")
    )
    printer: str = setting(
        "", "Name of the printer that `send` sends to, as `printer list` shows it."
    )
    start_gcode: str = setting(
        START,
        "G-code before the first move; {nozzle_temperature} stands for that of the first layer.",
    )
    end_gcode: str = setting(END, "G-code after the last move, with the same placeholders.")

    def bed_size(self) -> tuple[float, float]:
        """Width and depth of the bed (mm); `SettingError` where `bed` is not WIDTHxDEPTH."""
        try:
            width, depth = (float(word) for word in self.bed.lower().split("x"))
        except ValueError:
            width = depth = math.nan
        if not (0 < width < math.inf and 0 < depth < math.inf):
            raise SettingError("bed", f"--bed {self.bed}: write two lengths in mm, such as 220x220")
        return width, depth

    def wall_width(self) -> float:
        """Width of a wall between two cells as it is printed, mm."""
        return self.wall_beads * self.bead_width

    def solid_layers(self) -> tuple[int, int]:
        """How many layers are solid at faces that look down, and at those that look up."""
        return (0, 0) if self.open else (self.bottom_layers, self.top_layers)

    def rib_pitch(self) -> float:
        """Mm between the ribs that hold skins; 0 where there are none, as in walls of one bead."""
        if isinstance(self.skin_span, str) or self.wall_beads == 1:
            return 0.0
        return max(self.skin_span, LEAST_PITCH * self.bead_width)

    def retracts(self) -> bool:
        """Whether the filament is pulled back before a travel."""
        return self.retraction > 0 or self.retraction_by == "firmware"

    def acceleration_of(self, what: str) -> float:
        """Acceleration of perimeter, solid, bridge or travel, mm/s²."""
        value = getattr(self, f"{what}_acceleration")
        return self.acceleration if isinstance(value, str) else float(value)

    def first_layer_temperatures(self) -> tuple[float, float]:
        """Of nozzle and bed, °C; what is not heated is not heated on the first layer."""
        nozzle, bed = self.nozzle_temperature, self.bed_temperature
        return (
            max(nozzle + self.first_layer_hotter, 0.0) if nozzle else 0.0,
            max(bed + self.first_layer_bed_hotter, 0.0) if bed else 0.0,
        )

    def switches_for_travel(self) -> bool:
        """Whether each travel must be told its acceleration: Klipper has one for all moves."""
        extruding = (self.acceleration_of(what) for what in ("perimeter", "solid", "bridge"))
        same = {self.acceleration, self.acceleration_of("travel"), *extruding}
        return self.flavour == "klipper" and len(same) > 1

    def counts_from_before(self) -> bool:
        """Whether filament is counted from the move before; Klipper's arcs know no other way."""
        return self.extrusion == "relative" or (self.arcs and self.flavour == "klipper")

    def filament_area(self) -> float:
        """Cross-section of the filament, mm²."""
        return math.pi / 4 * self.filament_diameter**2


@dataclass(frozen=True, kw_only=True, slots=True)
class ExportSettings(Checked):
    """How a structure is exported."""

    boundary: str = setting(
        "auto",
        "The part in the .ont file: exact, or stl as in the thesis; auto is exact but for meshes.",
        choices=("auto", "exact", "stl"),
    )
    step_as: str = setting(
        "wires",
        "What the STEP file holds.",
        choices=("wires", "faces", "cells", "solid", "struts", "beads"),
    )
    threemf_as: str = setting(
        "solid",
        "What the 3MF file holds: a closed mesh, beams, which few slicers read, or a project for "
        "slicers: the part, its foam a modifier in it.",
        choices=("solid", "struts", "beads", "beams", "project"),
    )
    stl_as: str = setting(
        "walls", "What the STL file holds.", choices=("walls", "solid", "struts", "beads")
    )
    stl_ascii: bool = setting(False, "Write STL as text.")
    thickness: float = setting(0.8, "Thickness of solid walls.", unit="mm", above=0)
    skin: float = setting(0.0, "Thickness of a hull around solid walls.", unit="mm", least=0)
    diameter: float = setting(0.8, "Diameter of struts and beams.", unit="mm", above=0)
    svg_layer: int = setting(0, "The layer drawn as SVG; negative counts from the top.")

    def sizes(self, form: str, bead_width: float) -> dict[str, Any]:
        """What a form of `Structure.write_step` and its like takes."""
        if form == "solid":
            return {"thickness": self.thickness, "skin": self.skin}
        if form == "project":
            return {"thickness": self.thickness}
        if form in ("struts", "beams"):
            return {"diameter": self.diameter}
        return {"width": bead_width} if form == "beads" else {}
