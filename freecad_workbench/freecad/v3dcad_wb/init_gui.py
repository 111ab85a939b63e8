# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The workbench: toolbar, menu, preferences. Nothing is started before it is activated."""

import FreeCADGui as Gui
from freecad.v3dcad_wb.places import ICONS, TRANSLATIONS, icon
from freecad.v3dcad_wb.preferences import PreferencePage
from freecad.v3dcad_wb.qt import tr

Gui.addLanguagePath(str(TRANSLATIONS))
Gui.updateLocale()


class VoronoiWorkbench(Gui.Workbench):
    """Voronoi 3D."""

    MenuText = "Voronoi 3D"
    ToolTip = tr("Fill a part with a Voronoi foam that prints without support")
    Icon = icon("workbench")

    def Initialize(self) -> None:  # noqa: N802, FreeCAD's name
        """Make toolbar and menu, and load what the first fill needs, numpy above all."""
        from freecad.v3dcad_wb import commands, view_provider  # noqa: F401

        commands.register()
        self.appendToolbar("Voronoi 3D", commands.TOOLBAR)
        self.appendMenu("Voronoi 3D", commands.MENU)

    def Activated(self) -> None:  # noqa: N802
        """Start v3dcad, so that the first fill need not wait for it."""
        from freecad.v3dcad_wb import commands

        commands.activated()

    def GetClassName(self) -> str:  # noqa: N802
        """A workbench written in Python."""
        return "Gui::PythonWorkbench"


Gui.addIconPath(str(ICONS))
Gui.addPreferencePage(PreferencePage, "Voronoi 3D")
Gui.addWorkbench(VoronoiWorkbench())
