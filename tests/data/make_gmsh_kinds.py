"""Make gmsh_<kind>.msh, and of some kinds .unv and .med, by Gmsh's own hand.

A quarter of a ring, three cells around and two through, with groups.

Needs the gmsh Python package (pip install warpffrf[gmsh]); the tests read only the files. Lengths in mm.
Run: python tests/data/make_gmsh_kinds.py
"""

from __future__ import annotations

from pathlib import Path

RADII, WIDTH = (10.0, 15.0, 20.0), 5.0  # mm; the middle radius parts the groups inner and outer
# kind: recombined into quadrilaterals, order, without nodes in faces and cells, version of the file
KINDS = {
    "hex8": (True, 1, False, 4.1),
    "hex20": (True, 2, True, 4.1),
    "hex27": (True, 2, False, 2.2),
    "wedge6": (False, 1, False, 2.2),
    "wedge15": (False, 2, True, 4.1),
    "tet10": (False, 2, True, 4.1),
}
OTHERS = {"hex20", "wedge15", "tet10"}  # kinds that are also written as .unv and .med


def make(kind: str, file: Path) -> None:
    """Write the quarter ring meshed with `kind` to `file`."""
    import gmsh  # pyright: ignore[reportMissingImports] (an extra, only for making the files anew)

    recombined, order, incomplete, version = KINDS[kind]
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geo = gmsh.model.geo
    middle = geo.addPoint(0.0, 0.0, 0.0)
    first = [geo.addPoint(r, 0.0, 0.0) for r in RADII]
    last = [geo.addPoint(0.0, r, 0.0) for r in RADII]
    arcs = [geo.addCircleArc(a, middle, b) for a, b in zip(first, last, strict=True)]
    for arc in arcs:
        geo.mesh.setTransfiniteCurve(arc, 4)
    rim, volumes = [], []
    for i in range(2):
        low, high = geo.addLine(first[i], first[i + 1]), geo.addLine(last[i], last[i + 1])
        surface = geo.addPlaneSurface([geo.addCurveLoop([low, arcs[i + 1], -high, -arcs[i]])])
        for line in (low, high):
            geo.mesh.setTransfiniteCurve(line, 2)
        geo.mesh.setTransfiniteSurface(surface)
        if recombined:
            geo.mesh.setRecombine(2, surface)
        swept = geo.extrude([(2, surface)], 0.0, 0.0, WIDTH, numElements=[1], recombine=kind != "tet10")
        volumes.append(swept[1][1])
        rim = [swept[3][1]]  # top, volume, then the sides in the order of the loop: low, outer arc, ...
    geo.synchronize()
    for name, tag in zip(("inner", "outer"), volumes, strict=True):
        gmsh.model.addPhysicalGroup(3, [tag], name=name)
    gmsh.model.addPhysicalGroup(2, rim, name="rim")
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", int(incomplete))
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(order)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    for ending in (".msh", ".unv", ".med") if kind in OTHERS else (".msh",):
        gmsh.write(str(file.with_suffix(ending)))
    gmsh.finalize()


def main() -> None:
    for kind in KINDS:
        make(kind, Path(__file__).with_name(f"gmsh_{kind}.msh"))


if __name__ == "__main__":
    main()
