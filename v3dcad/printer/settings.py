"""Settings of printing over a port, declared once like all others."""

from __future__ import annotations

import math
from dataclasses import dataclass

from v3dcad.errors import SettingError
from v3dcad.printer.lines import LONGEST, command_of
from v3dcad.settings import Checked, setting

LONGEST_COMMAND = LONGEST - len("N4000000000 *255")
CANCEL = """\
M104 S0
M140 S0
M107
M84
"""


@dataclass(frozen=True, kw_only=True, slots=True)
class PortSettings(Checked):
    """How a printer on a cable is driven."""

    baud: int | str = setting(
        "auto",
        "Baud rate of the port; auto tries the usual ones.",
        least=300,
        most=4_000_000,
        words=("auto",),
    )
    reset: bool = setting(True, "Reset the board when the port is opened, if its wiring allows it.")
    park_at: str = setting(
        "stay",
        "Where the nozzle waits while a print is paused; stay leaves it over the part.",
        unit="mm",
        metavar="X,Y|stay",
    )
    park_lift: float = setting(
        10.0, "How far the nozzle is raised for a pause.", unit="mm", least=0, most=200
    )
    park_retraction: float = setting(
        2.0, "Filament pulled back for a pause.", unit="mm", least=0, most=50
    )
    cancel_gcode: str = setting(
        CANCEL,
        "G-code that ends a cancelled print. Heaters that the file turned on go off after it in "
        "any case.",
    )

    def park_place(self) -> tuple[float, float] | None:
        """X and Y to park at (mm), None to stay; `SettingError` if `park_at` is neither."""
        if self.park_at == "stay":
            return None
        try:
            x, y = (float(word) for word in self.park_at.split(","))
        except ValueError:
            x = y = math.nan
        if not (math.isfinite(x) and math.isfinite(y)):
            message = f"--park-at {self.park_at}: give two lengths in mm, such as 0,200, or stay"
            raise SettingError("park_at", message)
        return x, y

    def cancel_lines(self) -> list[str]:
        """The commands of `cancel_gcode`; `SettingError` for one that is too long."""
        lines = [line for line in map(command_of, self.cancel_gcode.splitlines()) if line]
        for line in lines:
            if len(line) > LONGEST_COMMAND:
                message = f"--cancel-gcode: {line}: at most {LONGEST_COMMAND} characters a line"
                raise SettingError("cancel_gcode", message)
        return lines


@dataclass(frozen=True, kw_only=True, slots=True)
class HostSettings(Checked):
    """A printer that is reached through a print server."""

    kind: str = setting(
        "octoprint",
        "What runs on the server.",
        choices=("octoprint", "moonraker", "prusalink"),
    )
    url: str = setting("", "The server's address.", metavar="http://HOST")
    user: str = setting("", "User name, of a PrusaLink that asks for user and password.")
    profile: str = setting(
        "", "Machine profile whose bed and height a file has to fit.", metavar="NAME|TOML"
    )
    nozzle: float = setting(
        0.0, "Diameter of the nozzle that a file has to be for; 0 takes any.", unit="mm", least=0
    )
    hottest_nozzle: float = setting(
        0.0, "Highest temperature of the nozzle; 0 sets no limit.", unit="°C", least=0
    )
    hottest_bed: float = setting(
        0.0, "Highest temperature of the bed; 0 sets no limit.", unit="°C", least=0
    )
