# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Without a window: `freecadcmd -t freecad.v3dcad_wb.tests.test_features`."""

from __future__ import annotations

import os
import subprocess
import tempfile
import unittest
from pathlib import Path
from typing import Any

import FreeCAD as App
import Part
from freecad.v3dcad_wb import environment, exchange, restore, source
from freecad.v3dcad_wb.backend import PREFIX, Job, worker
from freecad.v3dcad_wb.features import FRESH, make_voronoi_fill, request_of
from freecad.v3dcad_wb.places import PREFERENCES

SETTINGS = {"layer_height": 1.0, "cell_size": 7.0}


def cli(*words: str) -> None:
    """The command line, in the worker's environment."""
    subprocess.run(
        [str(environment.python()), "-m", "v3dcad", *words],
        env=environment.child_environment(),
        check=True,
        capture_output=True,
    )


def edges_of(path: Path) -> int:
    shape = Part.Shape()
    shape.importBrep(str(path))
    return int(shape.countElement("Edge"))


class Features(unittest.TestCase):
    def setUp(self) -> None:
        self.doc = App.newDocument("t")
        self.box = self.doc.addObject("Part::Box", "Box")
        self.box.Length, self.box.Width, self.box.Height = 30, 20, 12
        self.box.Placement.Base = App.Vector(5, -3, 2)
        self.doc.recompute()
        self.folder = Path(tempfile.mkdtemp(prefix="ü test "))

    def tearDown(self) -> None:
        App.closeDocument(self.doc.Name)

    @classmethod
    def tearDownClass(cls) -> None:
        worker.close()
        left = list(Path(tempfile.gettempdir()).glob(f"{PREFIX}{os.getpid()}*"))
        assert not left, left

    def fill(self, source: Any = None, **settings: Any) -> Any:
        return make_voronoi_fill(self.doc, source or self.box, {**SETTINGS, **settings})

    def test_the_same_as_the_command_line(self) -> None:
        fill = self.fill()
        self.assertEqual(fill.Status, FRESH)
        self.box.Shape.exportBrep(str(self.folder / "part.brep"))
        brep, ont = self.folder / "wires.brep", self.folder / "a.ont"
        sizes = ["--layer-height", "1", "--cell-size", "7"]
        part = str(self.folder / "part.brep")
        cli("fill", part, "--brep", str(brep), "--ont", str(ont), *sizes)
        theirs = Part.Shape()
        theirs.importBrep(str(brep))
        self.assertEqual(fill.Shape.countElement("Edge"), theirs.countElement("Edge"))
        ours, other = fill.Shape.BoundBox, theirs.BoundBox
        for name in ("XMin", "XMax", "YMin", "YMax", "ZMin", "ZMax"):
            self.assertAlmostEqual(getattr(ours, name), getattr(other, name), places=6)
        self.assertTrue(fill.Checksum)
        self.assertIn(fill.Checksum, ont.read_text(encoding="utf-8"))

    def test_changes_and_lies_where_the_source_lies(self) -> None:
        fill = self.fill()
        edges = fill.Edges
        self.assertTrue(self.box.Shape.BoundBox.isInside(fill.Shape.BoundBox.Center))
        self.assertAlmostEqual(fill.Shape.BoundBox.XMin, 5, places=4)
        self.assertGreater(fill.MassMade, 0)
        self.assertTrue(fill.Certificate)
        self.box.Height = 8
        self.doc.recompute()
        self.assertEqual(fill.Status, FRESH)
        self.assertLess(fill.Edges, edges)
        fill.CellSizeFrom = "auto"
        self.assertIn("stale", fill.Status)
        self.doc.recompute()
        self.assertEqual(fill.Status, FRESH)
        self.assertGreater(fill.CellSize.Value, 0)
        self.assertEqual(fill.CellSizeFrom, "auto")
        fill.setExpression("CellSize", "Box.Width / 4")
        self.doc.recompute()
        self.assertEqual(fill.CellSize.Value, 5)
        self.assertEqual(fill.CellSizeFrom, "given")
        self.assertAlmostEqual(fill.CellSizeMade.Value, 5, delta=1.5)

    def test_undo_of_a_result_says_that_a_recompute_is_needed(self) -> None:
        self.doc.UndoMode = 1
        fill = self.fill()
        edges = fill.Edges
        fill.CellSize = 10
        self.doc.recompute()
        self.assertLess(fill.Edges, edges)
        self.doc.undo()
        self.assertEqual(fill.Edges, edges)
        self.assertEqual(fill.Status, "stale: recompute", "nothing is computing")
        self.doc.recompute()
        self.assertEqual(fill.Status, FRESH)

    def test_cells_of_many_sizes_by_an_expression(self) -> None:
        fill = self.fill(cell_size="ramp(x, 5, 35, 4, 8)")
        self.assertEqual((fill.Status, fill.CellSizeFrom), (FRESH, "expression"))
        self.assertIn("Hidden", fill.getEditorMode("NearFaces"))
        self.box.Shape.exportBrep(str(self.folder / "part.brep"))
        ont, part = self.folder / "a.ont", str(self.folder / "part.brep")
        cli("fill", part, "--ont", str(ont), "--layer-height", "1",
            "--cell-size", "ramp(x, 5, 35, 4, 8)")  # fmt: skip
        self.assertTrue(fill.Checksum)
        self.assertIn(fill.Checksum, ont.read_text(encoding="utf-8"))
        fill.CellSizeExpression = "3 + q"
        self.doc.recompute()
        self.assertIn("failed: Cell size '3 + q': 'q' is not known", fill.Status)
        fill.CellSizeExpression = " "
        self.doc.recompute()
        self.assertIn("Write the cell size as an expression", fill.Status)
        fill.CellSize = 7
        self.doc.recompute()
        self.assertEqual((fill.Status, fill.CellSizeFrom), (FRESH, "given"))

    def test_cells_are_fine_near_faces(self) -> None:
        fill = self.fill()
        fill.FineSize, fill.CoarseSize = 4, 8
        self.assertEqual(fill.CellSizeFrom, "given")
        fill.NearFaces = [(self.box, ("Face1",))]  # x = 5, from y = -3 to 17, from z = 2 to 14
        self.assertEqual(fill.CellSizeFrom, "faces")
        self.doc.recompute()
        self.assertEqual(fill.Status, FRESH)
        near, far = (
            sum(lo <= edge.CenterOfMass.x - 5 <= hi for edge in fill.Shape.Edges)
            for lo, hi in ((1, 7), (23, 29))
        )
        self.assertGreater(near, 1.4 * far)
        made, count = fill.Made, worker._count
        worker.close()  # files of another folder are the same files
        worker.hello(lambda: None, self.fail)
        fill.touch()
        self.doc.recompute()
        self.assertEqual((fill.Made, worker._count), (made, count + 1), "only hello")
        self.box.Placement.Base.x = 105  # the faces go with it
        self.doc.recompute()
        self.assertEqual(fill.Status, FRESH)
        self.assertEqual(
            near, sum(1 <= edge.CenterOfMass.x - 105 <= 7 for edge in fill.Shape.Edges)
        )
        fill.CoarseFrom = 0
        self.doc.recompute()
        self.assertIn("more than 0", fill.Status)
        fill.NearFaces = []
        self.doc.recompute()
        self.assertIn("Select faces in the view", fill.Status)

    def test_cells_are_fine_where_stress_is_high(self) -> None:
        import Fem

        fill = self.fill()
        fill.FineSize, fill.CoarseSize = 4, 8
        fill.CellSizeFrom = "stress"
        self.doc.recompute()
        self.assertIn("Choose a result", fill.Status)
        mesh = self.doc.addObject("Fem::FemMeshObject", "Mesh")
        nodes = Fem.FemMesh()
        corners = [(x, y, z) for x in (5, 35) for y in (-3, 17) for z in (2, 14)]
        for number, corner in enumerate(corners, start=1):
            nodes.addNode(*(float(value) for value in corner), number)
        mesh.FemMesh = nodes
        result = self.doc.addObject("Fem::FemResultObject", "Result")
        result.Mesh = mesh
        fill.StressResult = result
        self.doc.recompute()
        self.assertIn("Result has no von Mises stress", fill.Status)
        result.addProperty("App::PropertyFloatList", "vonMises")
        result.NodeNumbers = list(range(1, 9))
        result.vonMises = [10.0 if corner[0] == 5 else 0.0 for corner in corners]
        self.doc.recompute()
        self.assertEqual(fill.Status, FRESH)
        near, far = (
            sum(lo <= edge.CenterOfMass.x - 5 <= hi for edge in fill.Shape.Edges)
            for lo, hi in ((1, 7), (23, 29))
        )
        self.assertGreater(near, 1.4 * far)
        fill.LowStress = 20
        self.doc.recompute()
        self.assertIn("above the low one", fill.Status)

    def test_nothing_is_computed_twice(self) -> None:
        fill = self.fill()
        count = worker._count
        fill.touch()
        self.doc.recompute()
        self.assertEqual(worker._count, count)

    def test_a_source_is_written_once_for_each_shape_and_place(self) -> None:
        written = []

        def keep(folder: Path, name: str, write: Any) -> str:
            written.append(name)
            return str(write_file(folder, name, write))

        write_file, source.keep = source.keep, keep
        try:
            fill = self.fill()
            self.assertEqual(len(written), 1)
            fill.CellSize = 8.0
            self.doc.recompute()
            self.assertEqual(len(written), 1)
            self.box.Placement.Base = App.Vector(5, -3, 4)
            self.doc.recompute()
            self.assertEqual(len(written), 2)
            self.assertAlmostEqual(fill.Shape.BoundBox.ZMin, 4.5)
            self.box.Height = 15
            self.doc.recompute()
            self.assertEqual(len(written), 3)
        finally:
            source.keep = write_file

    def test_thesis_method(self) -> None:
        fill = self.fill()
        fill.Method = "thesis"
        self.doc.recompute()
        self.assertEqual(fill.Status, FRESH)
        self.assertEqual(fill.CellSizeMade, 0)
        self.assertIn("Hidden", fill.getEditorMode("CellSize"))
        self.assertNotIn("Hidden", fill.getEditorMode("Sites"))

    def test_parts_in_containers_bodies_and_meshes(self) -> None:
        container = self.doc.addObject("App::Part", "Container")
        container.Placement = App.Placement(App.Vector(100, 0, 0), App.Rotation(0, 0, 90))
        container.addObject(self.box)
        self.doc.recompute()
        fill = self.fill()
        box, where = fill.Shape.BoundBox, container.Placement.multVec(App.Vector(5, -3, 2))
        self.assertTrue(box.XMin - 1e-3 <= where.x <= box.XMax + 1e-3)
        inside = self.fill()
        container.addObject(inside)
        inside.touch()
        self.doc.recompute()
        self.assertAlmostEqual(inside.Shape.BoundBox.XMin, 5, places=4)
        import MeshPart

        mesh = self.doc.addObject("Mesh::Feature", "Mesh")
        mesh.Mesh = MeshPart.meshFromShape(Part.makeBox(30, 20, 12), LinearDeflection=0.1)
        of_mesh = self.fill(mesh)
        self.assertEqual(of_mesh.Status, FRESH)
        self.assertGreater(of_mesh.Edges, 100)

    def test_refusals_leave_the_result(self) -> None:
        fill = self.fill()
        edges = fill.Edges
        fill.MaxOverhang = 3
        self.doc.recompute()
        self.assertIn("failed: Max overhang", fill.Status)
        self.assertEqual(fill.Edges, edges)
        self.assertTrue(fill.isValid())
        fill.MaxOverhang = 45
        fill.Source = None
        self.doc.recompute()
        self.assertIn("deleted", fill.Status)
        circle = self.doc.addObject("Part::Circle", "Circle")
        self.doc.recompute()
        fill.Source = circle
        self.doc.recompute()
        self.assertIn("encloses no volume", fill.Status)
        self.assertEqual(fill.Edges, edges)

    def test_a_crash_is_told_and_the_next_fill_works(self) -> None:
        fill = self.fill()
        worker._process.kill()
        worker._process.waitForFinished(5000)
        fill.CellSize = 6
        self.doc.recompute()
        if fill.Status != FRESH:
            self.assertIn("ended in the middle", fill.Status)
            fill.touch()
            self.doc.recompute()
        self.assertEqual(fill.Status, FRESH)

    def test_many_edges_are_lines_in_the_document(self) -> None:
        PREFERENCES.SetInt("ShapeUpTo", 100)
        try:
            fill = self.fill()
        finally:
            PREFERENCES.RemInt("ShapeUpTo")
        self.assertTrue(fill.Shape.isNull())
        self.assertEqual(fill.Status, FRESH)
        path = self.folder / "lines ü.FCStd"
        self.doc.saveAs(str(path))
        edges = fill.Edges
        App.closeDocument(self.doc.Name)
        self.doc = App.openDocument(str(path))
        import numpy as np

        with np.load(self.doc.VoronoiFill.Lines) as arrays:
            self.assertEqual(len(arrays["pairs"]), edges)
        self.assertNotIn("Touched", self.doc.VoronoiFill.State)

    def test_older_layouts_are_migrated(self) -> None:
        fill = self.fill()
        edges = fill.Edges
        fill.removeProperty("MaxOverhang")
        fill.removeProperty("Findings")
        fill.FillVersion = 0
        fill.Proxy = None
        restore.mend(fill)
        self.assertIn("Findings", fill.PropertiesList)
        self.assertEqual(fill.FillVersion, 1)
        fill.touch()
        self.doc.recompute()
        self.assertEqual(fill.MaxOverhang.Value, 45)
        self.assertEqual((fill.Status, fill.Edges), (FRESH, edges))

    def test_without_environment_it_says_so(self) -> None:
        named = os.environ.pop("V3DCAD_PYTHON")
        worker.close()
        try:
            self.assertIn("not set up", self.fill().Status)
            os.environ["V3DCAD_PYTHON"] = "/not/there"
            self.assertIn("is not there", self.fill().Status)
        finally:
            os.environ["V3DCAD_PYTHON"] = named
        fill = self.fill()
        self.assertEqual(fill.Status, FRESH)

    def test_brep_forms_exports_and_import(self) -> None:
        fill = self.fill()
        made: list[Any] = []
        for form in exchange.BREP_FORMS:
            exchange.create_brep(fill, form, {}, made.append, self.fail)
        wires, faces, cells, solid, struts = (obj.Shape for obj in made)
        self.assertEqual(wires.countElement("Edge"), fill.Edges)
        self.assertGreater(len(faces.Faces), 10)
        self.assertAlmostEqual(sum(cell.Volume for cell in cells.Solids), 30 * 20 * 12, places=1)
        self.assertGreater(solid.Volume, 0)
        self.assertGreater(struts.Volume, 0)
        told: list[Any] = []
        ont = self.folder / "a b.ont"
        exchange.export_fill(fill, str(ont), {}, told.append, self.fail)
        self.assertTrue(told[0]["lines"])
        opened = exchange.open(str(ont))
        again = opened.VoronoiFill
        self.assertEqual((again.Status, again.Checksum), (FRESH, fill.Checksum))
        App.closeDocument(opened.Name)

    def test_nowhere_to_write(self) -> None:
        fill = self.fill()
        told: list[Any] = []
        (self.folder / "file").touch()
        nowhere = str(self.folder / "file" / "a.ont")
        exchange.export_fill(fill, nowhere, {}, self.fail, told.append)
        self.assertEqual(len(told), 1)
        self.assertIn(str(self.folder / "file"), str(told[0]))

    def test_a_full_disk_is_told(self) -> None:
        fill = self.fill()
        before, worker._folder = worker._folder, self.folder / "gone"
        try:
            fill.CellSize = 6
            self.doc.recompute()
        finally:
            worker._folder = before
        self.assertIn("failed: the source could not be written", fill.Status)
        self.doc.recompute()

    def test_only_the_newest_preview_is_kept(self) -> None:
        _, request = request_of(self.fill())
        jobs = [
            Job({"do": "layer", **request, "layer": k, "target": "layer"}, _none, _none, "", "p")
            for k in range(3)
        ]
        worker.running = Job({}, _none, _none, "")
        App.GuiUp, before = 1, App.GuiUp
        try:
            for job in jobs:
                worker.ask(job)
        finally:
            App.GuiUp = before
        self.assertEqual(worker.waiting, jobs[2:])
        worker.waiting.clear()
        worker.running = None

    @unittest.skipUnless(os.environ.get("V3DCAD_BREAK"), "breaks on purpose when told to")
    def test_broken_on_purpose(self) -> None:
        self.assertEqual(self.fill().Edges, 1)


def _none(_: Any) -> None: ...
