"""Writes roller.msh, a warpffrf example: a hollow roller of second-order tetrahedra, its axis tilted and off-centre.

Requires the gmsh Python package (pip install "warpffrf[gmsh]"); reading the file does not. Lengths in mm.
Run: python make_roller.py
"""

from __future__ import annotations

import math
from pathlib import Path

OUTER_RADIUS, BORE_RADIUS, WIDTH = 50.0, 15.0, 20.0  # mm
CENTER = (12.0, -7.0, 31.0)  # mm, middle of the roller
AXIS = (0.2, 0.9, -0.35)  # along the roller, not normalised
RIM_SIZE, BORE_SIZE = 7.0, 8.0  # mm, element size: keeps the file below 1 MB
FILE = Path(__file__).with_name("roller.msh")
ABOUT = "A hollow roller of quadratic tetrahedra, tilted and off-centre, lengths in mm; a warpffrf example."


def main() -> None:
    import gmsh  # pyright: ignore[reportMissingImports] (an extra, only for making the file anew)

    length = math.sqrt(sum(a * a for a in AXIS))
    e_a = [a / length for a in AXIS]
    x, y, z = (c - 0.5 * WIDTH * a for c, a in zip(CENTER, e_a, strict=True))
    dx, dy, dz = (WIDTH * a for a in e_a)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("roller")
    outer = gmsh.model.occ.addCylinder(x, y, z, dx, dy, dz, OUTER_RADIUS)
    inner = gmsh.model.occ.addCylinder(x, y, z, dx, dy, dz, BORE_RADIUS)
    volumes, _ = gmsh.model.occ.cut([(3, outer)], [(3, inner)])
    gmsh.model.occ.synchronize()
    groups: dict[str, list[int]] = {"rim": [], "bore": [], "ends": []}
    for _, tag in gmsh.model.getEntities(2):
        if gmsh.model.getType(2, tag) == "Plane":
            groups["ends"].append(tag)
            continue
        lower, upper = gmsh.model.getParametrizationBounds(2, tag)
        middle = [0.5 * (a + b) for a, b in zip(lower, upper, strict=True)]
        offset = [x - c for x, c in zip(gmsh.model.getValue(2, tag, middle), CENTER, strict=True)]
        axial = sum(o * a for o, a in zip(offset, e_a, strict=True))
        radius = math.sqrt(sum(o * o for o in offset) - axial * axial)
        groups["rim" if radius > 0.5 * (OUTER_RADIUS + BORE_RADIUS) else "bore"].append(tag)
    for name, tags in groups.items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in volumes], name="roller")
    for name, size in (("bore", BORE_SIZE), ("rim", RIM_SIZE)):
        for tag in groups[name]:
            points = gmsh.model.getBoundary([(2, tag)], recursive=True)
            gmsh.model.mesh.setSize(points, size)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 1)
    gmsh.option.setNumber("Mesh.MeshSizeMax", max(RIM_SIZE, BORE_SIZE))
    gmsh.option.setNumber("Mesh.RandomSeed", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(str(FILE))
    gmsh.finalize()
    FILE.write_bytes(f"$Comments\n{ABOUT}\n$EndComments\n".encode() + FILE.read_bytes())


if __name__ == "__main__":
    main()
