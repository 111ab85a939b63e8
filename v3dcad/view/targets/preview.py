"""The door to all targets: what one shows of a structure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from v3dcad.errors import SettingError
from v3dcad.model import Layer, Placement, Toolpath
from v3dcad.view.targets import one_layer, whole
from v3dcad.view.targets.declared import target_of
from v3dcad.view.targets.shown import Preview
from v3dcad.view.targets.toolpath import toolpath


def preview(
    target: str,
    layers: Sequence[Layer],
    placement: Placement,
    index: int = 0,
    cell: int | None = None,
    neighbour: int | None = None,
    toolpaths: Iterable[Toolpath] = (),
    span: whole.Span = whole.NO_SPAN,
) -> Preview:
    """What a target shows of a structure's layers, where its source lies.

    `index` is the layer that is meant, `cell` and `neighbour` are site numbers, `toolpaths` those
    of all layers, ascending, `span` their `FillSettings.layer_span`; targets that need none of them
    leave them unread. Of layers that are
    computed when they are asked for, only one is, but by `full`, `cut` and `overhang`, which go
    through all. Raises `SettingError` for a target, layer, cell or neighbour that is not there.
    """
    target_of(target)
    if target in whole.SHOWS:
        return whole.SHOWS[target](layers, span).at_source(placement)
    if not 0 <= index < len(layers):
        raise SettingError("layer", f"layer {index}: the layers are 0 to {len(layers) - 1}")
    layer = layers[index]
    if target == "toolpath":
        shown = toolpath(layer, toolpaths)
    elif target in one_layer.SHOWS:
        shown = one_layer.SHOWS[target](layer)
    else:
        shown = one_layer.around_cell(target, layer, cell, neighbour)
    return shown.at_source(placement)
