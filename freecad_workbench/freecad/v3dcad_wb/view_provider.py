# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""How a fill is shown, in the tree and in the view."""

from __future__ import annotations

from typing import Any

import FreeCADGui as Gui

from .features import FRESH
from .lines import WALLS, Lines
from .places import icon
from .qt import tr


class ViewVoronoiFill:
    """The view provider of a fill: its shape, or one node of lines where there are too many."""

    def __init__(self, vobj: Any) -> None:
        vobj.Proxy = self
        vobj.LineColor = WALLS
        vobj.LineWidth = 1
        vobj.PointSize = 1

    def attach(self, vobj: Any) -> None:
        """Called when the object is shown for the first time, and again when it is opened."""
        self.object = vobj.Object
        self.lines = Lines(width=1.0)
        vobj.RootNode.insertChild(self._switch(vobj), 0)
        self._show_lines()

    def _switch(self, vobj: Any) -> Any:
        from pivy import coin

        self.switch = coin.SoSwitch()
        self.switch.addChild(self.lines.node)
        self.switch.whichChild = coin.SO_SWITCH_ALL if vobj.Visibility else coin.SO_SWITCH_NONE
        return self.switch

    def updateData(self, obj: Any, name: str) -> None:  # noqa: N802, FreeCAD's name
        """A property of the object has changed."""
        if name in ("Lines", "Shape"):
            self._show_lines()
        elif name == "Status":
            obj.ViewObject.signalChangeIcon()

    def onChanged(self, vobj: Any, name: str) -> None:  # noqa: N802
        """A property of the view has changed."""
        if name == "Visibility" and hasattr(self, "switch"):
            self.switch.whichChild = -3 if vobj.Visibility else -1

    def _show_lines(self) -> None:
        obj = getattr(self, "object", None)
        if obj is None or not hasattr(obj, "Lines"):
            return
        if obj.Lines and obj.Shape.isNull():
            self.lines.show_file(obj.Lines)
        else:
            self.lines.clear()

    def getIcon(self) -> str:  # noqa: N802
        """A warning while the result does not belong to the settings."""
        fresh = getattr(self, "object", None) is None or self.object.Status == FRESH
        return icon("fill" if fresh else "stale")

    def claimChildren(self) -> list[Any]:  # noqa: N802
        """The part that is filled stays where it is in the tree."""
        return []

    def doubleClicked(self, vobj: Any) -> bool:  # noqa: N802
        """Edit the fill."""
        return bool(vobj.Document.setEdit(vobj.Object.Name, 0))

    def setupContextMenu(self, vobj: Any, menu: Any) -> None:  # noqa: N802
        """Edit by the context menu."""
        action = menu.addAction(tr("Edit the fill"))
        action.triggered.connect(lambda: self.doubleClicked(vobj))

    def setEdit(self, vobj: Any, mode: int = 0) -> bool:  # noqa: N802
        """Show the task panel."""
        from .taskpanel import FillPanel

        if mode != 0:
            return False
        Gui.Control.showDialog(FillPanel(vobj.Object))
        return True

    def unsetEdit(self, vobj: Any, mode: int = 0) -> bool:  # noqa: N802
        """Close the task panel."""
        Gui.Control.closeDialog()
        return True

    def dumps(self) -> None:
        """Nothing is saved."""
        return

    def loads(self, state: Any) -> None:
        """See `dumps`."""
        return

    __getstate__ = dumps
    __setstate__ = loads
