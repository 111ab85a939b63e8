"""STEP of bare curves, written as text: a hundred thousand edges a second, and few bytes each.

One product for each drawing, its curves in one GEOMETRIC_CURVE_SET, as ISO 10303-21 (Part 21) has
it: straight runs are POLYLINEs through shared points, arcs are TRIMMED_CURVEs of exact CIRCLEs and
ELLIPSEs, splines B_SPLINE_CURVE_WITH_KNOTS. CAD programs read it as wires; it has no topology.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from v3dcad.geometry.drawing import Conic, Drawing, Spline

DIGITS = 8
"""Decimals of a point's coordinates, mm: a tenth of OCCT's tolerance."""

SCHEMAS = {
    "AP214": (
        "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
        "core data for automotive mechanical design processes",
        "'international standard','automotive_design',2000",
    ),
    "AP242": (
        "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {1 0 10303 442 1 1 4 }",
        "Managed model based 3d engineering",
        "'international standard','ap242_managed_model_based_3d_engineering',2013",
    ),
}
"""Name of the schema, application and its protocol."""


def step_text(drawings: Iterable[Drawing], name: str, schema: str, timestamp: str) -> Iterator[str]:
    """Drawings as pieces of a STEP file, mm, of a schema in `SCHEMAS`."""
    title, application, protocol = SCHEMAS[schema]
    yield (
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('v3dcad'),'2;1');\n"
        f"FILE_NAME({_text(name)},'{timestamp}',(''),(''),'v3dcad','v3dcad','');\n"
        f"FILE_SCHEMA(('{title}'));\nENDSEC;\nDATA;\n"
        f"#1=APPLICATION_CONTEXT('{application}');\n"
        f"#2=APPLICATION_PROTOCOL_DEFINITION({protocol},#1);\n"
        "#3=PRODUCT_CONTEXT('',#1,'mechanical');\n"
        "#4=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');\n"
        "#5=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
        "#6=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\n"
        "#7=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());\n"
        "#8=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#5,"
        "'distance_accuracy_value','confusion accuracy');\n"
        "#9=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#8))"
        "GLOBAL_UNIT_ASSIGNED_CONTEXT((#5,#6,#7))REPRESENTATION_CONTEXT('','3D'));\n"
        "#10=CARTESIAN_POINT('',(0.,0.,0.));\n"
        "#11=DIRECTION('',(0.,0.,1.));\n"
        "#12=DIRECTION('',(1.,0.,0.));\n"
        "#13=AXIS2_PLACEMENT_3D('',#10,#11,#12);\n"
    )
    rows = _Rows(13)
    for drawing in drawings:
        yield rows.product(drawing)
    yield "ENDSEC;\nEND-ISO-10303-21;\n"


class _Rows:
    """Entities, numbered from one drawing to the next."""

    def __init__(self, last: int) -> None:
        self.last = last
        self.rows: list[str] = []

    def add(self, entity: str) -> int:
        """Add an entity and give its number."""
        self.last += 1
        self.rows.append(f"#{self.last}={entity};\n")
        return self.last

    def product(self, drawing: Drawing) -> str:
        """All entities of a drawing."""
        first = self.last + 1
        used = np.unique(np.concatenate([*drawing.polylines, np.empty(0, np.int64)]))
        # Rounded first: what is written has no −0.
        points = (np.round(drawing.points[used], DIGITS) + 0.0).tolist()
        self.rows += [
            f"#{number}=CARTESIAN_POINT('',({x:.8f},{y:.8f},{_real(z)}));\n"
            for number, (x, y, z) in enumerate(points, start=first)
        ]
        self.last += len(points)
        numbers = np.zeros(len(drawing.points), np.int64)
        numbers[used] = first + np.arange(len(used))
        curves = [self.polyline(numbers[line].tolist()) for line in drawing.polylines]
        curves += [self.conic(conic) for conic in drawing.conics]
        curves += [self.spline(spline) for spline in drawing.splines]
        title = _text(drawing.name)
        held = self.add(f"GEOMETRIC_CURVE_SET('',{_refs(curves)})")
        shape = self.add(
            f"GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION('',(#13,#{held}),#9)"
        )
        product = self.add(f"PRODUCT({title},{title},'',(#3))")
        self.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
        definition = self.add(f"PRODUCT_DEFINITION('design','',#{formation},#4)")
        meaning = self.add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION(#{meaning},#{shape})")
        rows, self.rows = self.rows, []
        return "".join(rows)

    def polyline(self, points: list[int]) -> int:
        """A chain of straight lines between points."""
        return self.add(f"POLYLINE('',{_refs(points)})")

    def conic(self, conic: Conic) -> int:
        """An arc."""
        centre = self.add(f"CARTESIAN_POINT('',{_vector(conic.centre)})")
        axis = self.add(f"DIRECTION('',{_vector(conic.axis)})")
        towards = self.add(f"DIRECTION('',{_vector(conic.towards)})")
        frame = self.add(f"AXIS2_PLACEMENT_3D('',#{centre},#{axis},#{towards})")
        major, minor = _real(conic.major), _real(conic.minor)
        curve = self.add(
            f"CIRCLE('',#{frame},{major})"
            if major == minor
            else f"ELLIPSE('',#{frame},{major},{minor})"
        )
        first, last = _real(conic.first), _real(conic.last)
        return self.add(
            f"TRIMMED_CURVE('',#{curve},(PARAMETER_VALUE({first})),(PARAMETER_VALUE({last})),"
            ".T.,.PARAMETER.)"
        )

    def spline(self, spline: Spline) -> int:
        """A B-spline."""
        poles = [self.add(f"CARTESIAN_POINT('',{_vector(pole)})") for pole in spline.poles.tolist()]
        times = ",".join(map(str, spline.multiplicities))
        knots = ",".join(map(_real, spline.knots))
        return self.add(
            f"B_SPLINE_CURVE_WITH_KNOTS('',{spline.degree},{_refs(poles)},.UNSPECIFIED.,.F.,.F.,"
            f"({times}),({knots}),.UNSPECIFIED.)"
        )


def _refs(numbers: list[int]) -> str:
    return f"(#{',#'.join(map(str, numbers))})"


def _vector(values: Iterable[float]) -> str:
    return f"({','.join(map(_real, values))})"


def _real(value: float) -> str:
    """A number to the last bit, as Part 21 writes it: with a point, and E before an exponent."""
    mantissa, _, exponent = repr(float(value) + 0.0).partition("e")
    point = "" if "." in mantissa else "."
    return f"{mantissa}{point}E{exponent}" if exponent else mantissa


def _text(text: str) -> str:
    """A string as Part 21 writes it: what is not ASCII by its number, in hexadecimal.

    What is no letter at all, as in a file's name that is not UTF-8, is a question mark.
    """
    written = []
    for letter in text:
        if " " <= letter <= "~":
            written.append({"'": "''", "\\": "\\\\"}.get(letter, letter))
        else:
            number = letter.encode("utf-32-be", "replace").hex().upper()
            short = number.removeprefix("0000")
            written.append(f"\\X{len(short) // 2}\\{short}\\X0\\")
    return f"'{''.join(written)}'"
