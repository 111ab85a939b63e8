# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Fills in documents that are opened: lost proxies come back, older layouts are brought up to date.

A document that was saved where the add-on is missing has lost its proxies; one that was made
without a window has no view providers. Observers see no end of restoring: `slotActivateDocument`
comes after it, with all objects, with and without a window.
"""

from __future__ import annotations

from typing import Any

import FreeCAD as App

from . import features

RENAMED: dict[int, dict[str, str]] = {}
"""By the version that had them: old names of properties, and what they are called since."""


class Observer:
    """Watches documents."""

    def slotActivateDocument(self, doc: Any) -> None:  # noqa: N802, FreeCAD's name
        """Mend the fills of a document that was just opened."""
        for obj in doc.Objects:
            if features.is_fill(obj):
                mend(obj)


def mend(obj: Any) -> None:
    """Give a fill what it lacks; computes nothing and leaves it untouched."""
    touched = "Touched" in obj.State
    if not isinstance(obj.Proxy, features.VoronoiFill):
        proxy = features.VoronoiFill.__new__(features.VoronoiFill)
        proxy.start()
        obj.Proxy = proxy
    if App.GuiUp:
        from .view_provider import ViewVoronoiFill

        if not isinstance(obj.ViewObject.Proxy, ViewVoronoiFill):
            ViewVoronoiFill(obj.ViewObject)
    if obj.FillVersion < features.VERSION:
        migrate(obj)
    if not touched:
        obj.purgeTouched()


def migrate(obj: Any) -> None:
    """Bring an older layout up to date; settings that it lacks come with the next recompute."""
    for version in range(obj.FillVersion, features.VERSION):
        for old, new in RENAMED.get(version, {}).items():
            value, kind = getattr(obj, old), obj.getTypeIdOfProperty(old)
            obj.addProperty(kind, new, obj.getGroupOfProperty(old))
            setattr(obj, new, value)
            obj.removeProperty(old)
    features.add_fixed(obj)


def watch() -> None:
    """Begin to watch documents."""
    App.addDocumentObserver(_OBSERVER)


_OBSERVER = Observer()
