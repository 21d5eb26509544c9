"""The parts of the examples, as a CAD program would export them: python examples/parts.py writes plate.step and bracket.step, lengths in mm."""

from pathlib import Path

from netgen.occ import WorkPlane, Z

FOLDER = Path(__file__).parent


def plate():
    """400 × 400 × 5, with a hole of radius 10 in its middle."""
    outline = WorkPlane().RectangleC(400, 400).Face() - WorkPlane().Circle(0, 0, 10).Face()
    return outline.Extrude(5 * Z)


def bracket():
    """An angle of 20 × 20, legs of 100 and 120, thickness 8, with a fillet of radius 10 in its corner."""
    angle = WorkPlane().MoveTo(0, 0).LineTo(120, 0).LineTo(120, 20).LineTo(20, 20).LineTo(20, 100).LineTo(0, 100).Close().Face().Extrude(8 * Z)
    return angle.MakeFillet([edge for edge in angle.edges if abs(edge.center.x - 20) + abs(edge.center.y - 20) < 1e-6], 10)


if __name__ == "__main__":
    plate().WriteStep(str(FOLDER / "plate.step"))
    bracket().WriteStep(str(FOLDER / "bracket.step"))
