"""Make roller_4mm.msh: a hollow roller with axis y of second-order tetrahedra, about 4 mm long at the rim.

Facet groups `rim`, `bore` and `ends`, one cell group `roller`. Cells grow towards the bore: the file stays below 1 MB.
Requires the gmsh Python package (pip install warpffrf[gmsh]); demos and tests read only the file. Lengths in mm.
Run: python demos/data/make_roller_4mm.py
"""

from __future__ import annotations

import math
from pathlib import Path

OUTER_RADIUS, BORE_RADIUS, WIDTH = 50.0, 15.0, 20.0  # mm
RIM_SIZE, BORE_SIZE = 4.0, 6.5  # mm, edges of the cells
FILE = Path(__file__).with_name("roller_4mm.msh")


def main() -> None:
    import gmsh  # pyright: ignore[reportMissingImports] (an extra, only for making the file again)

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("roller_4mm")
    begin_and_way = (0.0, -0.5 * WIDTH, 0.0, 0.0, WIDTH, 0.0)
    outer, inner = (gmsh.model.occ.addCylinder(*begin_and_way, radius) for radius in (OUTER_RADIUS, BORE_RADIUS))
    volumes, _ = gmsh.model.occ.cut([(3, outer)], [(3, inner)])
    gmsh.model.occ.synchronize()
    groups: dict[str, list[int]] = {"rim": [], "bore": [], "ends": []}
    for _, tag in gmsh.model.getEntities(2):
        if gmsh.model.getType(2, tag) == "Plane":
            groups["ends"].append(tag)
            continue
        lower, upper = gmsh.model.getParametrizationBounds(2, tag)
        x, _, z = gmsh.model.getValue(2, tag, [0.5 * (a + b) for a, b in zip(lower, upper, strict=True)])
        groups["rim" if math.hypot(x, z) > 0.5 * (OUTER_RADIUS + BORE_RADIUS) else "bore"].append(tag)
    for name, tags in groups.items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in volumes], name="roller")
    size = gmsh.model.mesh.field.add("MathEval")
    slope = (BORE_SIZE - RIM_SIZE) / (OUTER_RADIUS - BORE_RADIUS)
    gmsh.model.mesh.field.setString(size, "F", f"{RIM_SIZE}+{slope}*({OUTER_RADIUS}-Sqrt(x*x+z*z))")
    gmsh.model.mesh.field.setAsBackgroundMesh(size)
    for option in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
    gmsh.option.setNumber("Mesh.RandomSeed", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)  # half the size of 4.1, which numbers with 64 bits
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(str(FILE))
    gmsh.finalize()


if __name__ == "__main__":
    main()
