"""The slicer against OCCT's section (B-rep), trimesh and manifold3d (triangles).

`python benchmarks/slicing.py [part …]` prints the tables of docs/slicing-performance.md.
Times are processor time of one run, but for those of workers, which are the clock's; ratios are
what to compare.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import manifold3d
import numpy as np
import trimesh

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt

from tests.kernel import shapes
from tests.parts import read_stl
from v3dcad.geometry.mesh.section import mesh_edges, section_mesh
from v3dcad.kernel.mesh import surface_mesh
from v3dcad.kernel.section import section_solids
from v3dcad.kernel.shapes import FACE, subshapes

PLANES = 200
OCCT_SECONDS = 3.0


def drilled_plate():
    plate = shapes.box((0, 0, 0), (60, 40, 20))
    for x in (12, 30, 48):
        for y in (10, 30):
            plate = shapes.cut(plate, shapes.cylinder(3.5, 30, (x, y, -5)))
    return shapes.cut(plate, shapes.cylinder(3, 90, (-10, 20, 10), (1, 0, 0)))


PARTS = {
    "cone": lambda: shapes.cone(20, 15, 30),
    "drilled plate": drilled_plate,
    "tilted torus": lambda: shapes.torus(20, 7, along=(0.3, 0.2, 1)),
    "spline loft": shapes.loft,
    **{name: (lambda name=name: shapes.nist(name)) for name in shapes.NIST},
}


def seconds(job: Callable[[], object], times: int = 3) -> float:
    """The least time of some runs."""
    return min(_timed(job) for _ in range(times))


def _timed(job: Callable[[], object]) -> float:
    start = time.process_time()
    job()
    return time.process_time() - start


def clocked(job: Callable[[], object]) -> float:
    """Seconds by the clock, for work that others share in."""
    start = time.perf_counter()
    job()
    return time.perf_counter() - start


def occt_ms(shape, heights) -> float:
    """OCCT's section with approximation on, ms a plane, on as many planes as there is time for."""
    start, done = time.process_time(), 0
    for z in np.random.default_rng(0).permutation(heights).tolist():
        cutter = BRepAlgoAPI_Section(shape, gp_Pln(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), False)
        cutter.Approximation(True)
        cutter.Build()
        done += 1
        if time.process_time() - start > OCCT_SECONDS:
            break
    return (time.process_time() - start) / done * 1e3


def middles(z, count: int):
    return z.min() + (z.max() - z.min()) * (np.arange(count) + 0.5) / count


def brep_rows(names) -> Iterator[str]:
    yield "| part | faces | OCCT, ms a plane | preparation, s | ours, ms a plane | all in | ratio |"
    yield "|---|---|---|---|---|---|---|"
    for name in names:
        shape = PARTS[name]()
        mesh = surface_mesh(shape)
        heights = middles(mesh.nodes[:, 2], PLANES)
        list(section_solids(mesh, heights[:3]))
        preparing = seconds(lambda shape=shape: surface_mesh(shape))
        cutting = seconds(lambda mesh=mesh, at=heights: list(section_solids(mesh, at)))
        each, whole = cutting / PLANES * 1e3, (preparing + cutting) / PLANES * 1e3
        occt = occt_ms(shape, heights)
        faces = len(list(subshapes(shape, FACE)))
        yield (
            f"| {name} | {faces} | {occt:.2f} | {preparing:.3f} | {each:.3f} | {whole:.3f} "
            f"| {occt / whole:.0f}× |"
        )


def mesh_rows() -> Iterator[str]:
    bunny = read_stl("bunny.stl")
    corners, faces = bunny.vertices, bunny.triangles
    for _ in range(2):
        corners, faces = trimesh.remesh.subdivide(corners, faces)
    mesh = type(bunny)(np.asarray(corners), np.asarray(faces, np.int64))
    heights = middles(mesh.vertices[:, 2], 500)
    section_mesh(mesh, heights[:2])
    preparing = seconds(lambda: mesh_edges(mesh.triangles))
    whole = seconds(lambda: section_mesh(mesh, heights))
    solid = trimesh.Trimesh(corners, faces, process=False)
    few = heights[::25]
    theirs = seconds(
        lambda: [solid.section(plane_origin=[0, 0, z], plane_normal=[0, 0, 1]) for z in few], 1
    )
    manifold = manifold3d.Manifold(
        manifold3d.Mesh64(np.ascontiguousarray(corners), np.asarray(faces, np.uint64))
    )
    slicing = seconds(lambda: [manifold.slice(z).to_polygons() for z in heights[::5]], 1)
    yield f"Bunny, {len(faces)} triangles, {len(heights)} planes, ms a plane:"
    yield ""
    yield "| preparation, s | ours, with preparation | trimesh | manifold3d |"
    yield "|---|---|---|---|"
    yield (
        f"| {preparing:.3f} | {whole / 500 * 1e3:.3f} "
        f"| {theirs / len(few) * 1e3:.2f} | {slicing / 100 * 1e3:.3f} |"
    )


def parallel_rows() -> Iterator[str]:
    mesh = surface_mesh(PARTS["ctc_02_asme1_rc"]())
    heights = middles(mesh.nodes[:, 2], 3000)
    # Warm up, so that starting a worker and loading compiled code are not counted.
    yield "| CTC-02, 3000 planes | s | speed-up |"
    yield "|---|---|---|"
    alone = clocked(lambda: list(section_solids(mesh, heights)))
    yield f"| alone | {alone:.2f} | 1 |"
    with ThreadPoolExecutor(2) as threads:
        together = clocked(lambda: list(section_solids(mesh, heights, executor=threads)))
    yield f"| 2 threads | {together:.2f} | {alone / together:.2f} |"
    with ProcessPoolExecutor(2, get_context("spawn")) as processes:
        list(section_solids(mesh, heights[:256], executor=processes))
        together = clocked(lambda: list(section_solids(mesh, heights, executor=processes)))
    yield f"| 2 processes | {together:.2f} | {alone / together:.2f} |"


def main() -> None:
    chosen = sys.argv[1:]
    for row in brep_rows(chosen or PARTS):
        print(row, flush=True)
    if not chosen:
        for table in (mesh_rows(), parallel_rows()):
            print()
            for row in table:
                print(row, flush=True)


if __name__ == "__main__":
    main()
