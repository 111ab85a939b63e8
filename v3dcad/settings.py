"""Every setting, declared once: name, unit, range, default, help.

The command line's options, the `.ont` file, the workbench's properties and the
documentation are all made from these classes. Imports nothing heavy, so that
`v3dcad --help` stays quick.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, TypeVar

from v3dcad.errors import SettingError

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Declared:
    """What is known of one setting besides its type and default."""

    help: str
    unit: str = ""
    metavar: str | None = None
    above: float = -math.inf
    least: float = -math.inf
    most: float = math.inf

    def check(self, name: str, value: object) -> None:
        """Raise `SettingError` unless a numeric value lies in the declared range."""
        if not isinstance(value, (int, float)):
            return
        unit = f" {self.unit}" if self.unit else ""
        if not math.isfinite(value):
            raise SettingError(name, f"{option(name)} {value}: give a finite number{unit}")
        if value <= self.above:
            raise SettingError(
                name, f"{option(name)} {value}: give a number above {self.above:g}{unit}"
            )
        if value < self.least:
            raise SettingError(
                name, f"{option(name)} {value}: give a number of at least {self.least:g}{unit}"
            )
        if value > self.most:
            raise SettingError(
                name, f"{option(name)} {value}: give a number of at most {self.most:g}{unit}"
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
            declared(type(self), name).check(name, getattr(self, name))


@dataclass(frozen=True, kw_only=True, slots=True)
class FillSettings(Checked):
    """How a part is filled."""

    layer_height: float = setting(0.2, "Distance between two layers.", unit="mm", above=0)
    offset: float = setting(
        0.2, "Weight that a growing cell gains in each layer.", unit="mm²", least=0
    )
    sites: int = setting(
        40, "Number of sites, scattered evenly in the base rectangle.", least=1, most=10_000_000
    )
    random_seed: int = setting(0, "Seed of the scatter.", least=0, most=2**63 - 1)
    insertion: bool = setting(True, "New cells are born where cells have become too large.")
    method: str = setting("continuous", "How cells are born: continuous, or as in the thesis.")


@dataclass(frozen=True, kw_only=True, slots=True)
class PrintSettings(Checked):
    """How a structure is printed. The defaults are Table 3.2 of the thesis."""

    first_layer_height: float = setting(
        0.2, "Height of the first layer's beads.", unit="mm", above=0
    )
    bead_width: float = setting(
        0.8, "Width of one extruded bead; the nozzle's diameter.", unit="mm", above=0
    )
    print_speed: float = setting(10.0, "Speed while extruding.", unit="mm/s", above=0)
    travel_speed: float = setting(50.0, "Speed while not extruding.", unit="mm/s", above=0)
    filament_diameter: float = setting(1.75, "Diameter of the filament.", unit="mm", above=0)
    flow: float = setting(100.0, "Share of the computed material extruded.", unit="%", above=0)
    retraction: float = setting(
        0.0, "Filament pulled back before a travel.", unit="mm", least=0, most=50
    )
    nozzle_temperature: float = setting(
        200.0, "Temperature of the nozzle.", unit="°C", least=0, most=500
    )
    bed_temperature: float = setting(60.0, "Temperature of the bed.", unit="°C", least=0, most=200)
    bed: str = setting("220x220", "Width and depth of the bed.", unit="mm", metavar="WIDTHxDEPTH")

    def bed_size(self) -> tuple[float, float]:
        """Width and depth of the bed (mm); `SettingError` where `bed` is not WIDTHxDEPTH."""
        try:
            width, depth = (float(word) for word in self.bed.lower().split("x"))
        except ValueError:
            width = depth = math.nan
        if not (0 < width < math.inf and 0 < depth < math.inf):
            raise SettingError("bed", f"--bed {self.bed}: write two lengths in mm, such as 220x220")
        return width, depth
