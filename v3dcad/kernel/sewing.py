"""Solids of loose faces: sewn to shells, and the shells nested as bodies with cavities."""

from __future__ import annotations

from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeSolid, BRepBuilderAPI_Sewing
from OCP.TopoDS import TopoDS, TopoDS_Shape, TopoDS_Shell, TopoDS_Solid

from v3dcad.errors import KernelError
from v3dcad.kernel.booleans import common
from v3dcad.kernel.orientation import upright
from v3dcad.kernel.shapes import FACE, SHELL, compound, subshapes, volume
from v3dcad.words import counted

SEWING = 1e-4
"""mm: edges of loose faces that are nearer than this are sewn, unless told otherwise."""

WHOLE = 1 - 1e-6
"""Share of a body's volume that another one has to hold to contain it."""


def sewn(
    shape: TopoDS_Shape, where: str, findings: list[str], gap: float = SEWING
) -> list[TopoDS_Shape]:
    """The solids that the faces of a shape without solids enclose, sewn where within `gap`, mm.

    A shell that lies inside another one bounds a cavity of it, a shell inside a cavity is a body
    again, and so on. Shells beside each other, or that cross, are bodies of their own. Findings say
    what was sewn and what was left out. `KernelError`, naming `where`, where nothing is enclosed.
    """
    faces = sum(1 for _ in subshapes(shape, FACE))
    if not faces:
        raise KernelError(f"{where}: contains no solid and no face; export a solid")
    sewing = BRepBuilderAPI_Sewing(gap)
    sewing.Add(shape)
    sewing.Perform()
    whole = compound([sewing.SewedShape()])
    shells = [*subshapes(whole, SHELL), *map(_shell_of, subshapes(whole, FACE, SHELL))]
    closed = [shell for shell in shells if BRep_Tool.IsClosed_s(shell)]
    if not closed:
        raise KernelError(
            f"{where}: contains no solid, only {counted(faces, 'face')} without an inside, with "
            f"{counted(sewing.NbFreeEdges(), 'open edge')} even when sewn within {gap:.1g} mm; "
            "close the surface where it was made, and export a solid"
        )
    unsaid: list[str] = []
    bodies = [
        upright(BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(shell)).Solid(), unsaid) for shell in closed
    ]
    solids, cavities = nested(bodies)
    used = sum(1 for shell in closed for _ in subshapes(shell, FACE))
    found = counted(len(solids), "solid")
    inside = f" with {counted(cavities, 'cavity')}" if cavities else ""
    findings.append(f"sewed {counted(used, 'face')}, which no solid had, to {found}{inside}")
    left = sum(1 for _ in subshapes(whole, FACE)) - used
    if left:
        findings.append(f"left out {counted(left, 'face')} without an inside")
    return solids


def _shell_of(face: TopoDS_Shape) -> TopoDS_Shape:
    """A face alone as a shell, as a sphere is one: sewing makes none of it."""
    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    builder.Add(shell, face)
    return shell


def nested(bodies: list[TopoDS_Shape]) -> tuple[list[TopoDS_Shape], int]:
    """Bodies of one shell each as solids with cavities, and how many cavities they have.

    A body's depth is that of the smallest one that contains it, plus one: what has an odd depth is
    a cavity of the body around it.
    """
    sizes = [volume(body) for body in bodies]
    order = sorted(range(len(bodies)), key=lambda k: -sizes[k])
    depth: dict[int, int] = {}
    hollow: dict[int, list[int]] = {}
    for place, k in enumerate(order):
        around = (
            j
            for j in reversed(order[:place])
            if sizes[k] < WHOLE * sizes[j] and _contains(bodies[j], bodies[k], sizes[k])
        )
        parent = next(around, None)
        depth[k] = 0 if parent is None else depth[parent] + 1
        if parent is None or depth[k] % 2 == 0:
            hollow[k] = []
        else:
            hollow[parent].append(k)
    solids = [_with_cavities(bodies[k], [bodies[c] for c in hollow[k]]) for k in sorted(hollow)]
    return solids, len(bodies) - len(solids)


def _contains(outer: TopoDS_Shape, inner: TopoDS_Shape, size: float) -> bool:
    return volume(common([inner], [outer])) >= WHOLE * size


def _with_cavities(body: TopoDS_Shape, cavities: list[TopoDS_Shape]) -> TopoDS_Shape:
    if not cavities:
        return body
    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    for part in (body, *(cavity.Reversed() for cavity in cavities)):
        for shell in subshapes(part, SHELL):
            builder.Add(solid, shell)
    return solid
