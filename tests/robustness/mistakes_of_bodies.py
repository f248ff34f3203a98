"""Mistakes with materials, meshes and reductions; see `workshop`."""

from __future__ import annotations

from workshop import BOLT, STEEL, Mistake, reduce_roller, roller_mesh, untyped

import warpffrf as wf

reduce, Material, mesh = untyped(wf.reduce), untyped(wf.Material), untyped(wf.mesh)
ContactGrid = untyped(wf.ContactGrid)

MATERIALS = (
    Mistake(
        "E in GPa", lambda w: reduce_roller(wf.Material(210, 0.3, 7850)), ("youngs_modulus 210 GPa is 2.1e+11 Pa",)
    ),
    Mistake("E in MPa", lambda w: reduce_roller(wf.Material(210e3, 0.3, 7850)), ("210000 MPa is 2.1e+11 Pa",)),
    Mistake(
        "density in g/cm3", lambda w: reduce_roller(wf.Material(210e9, 0.3, 7.85)), ("density 7.85 g/cm3 is 7850",)
    ),
    Mistake(
        "MPa and t/mm3 of a deck",
        lambda w: reduce_roller(wf.Material(210e3, 0.3, 7.85e-9)),
        ("210000 MPa is 2.1e+11 Pa", "7.85e-09 t/mm3 is 7850 kg/m3"),
    ),
    Mistake(
        "density first", lambda w: reduce_roller(wf.Material(7850, 0.3, 210e9)), ("no solid has a density of 2.1e+11",)
    ),
    Mistake(
        "nu of an incompressible one", lambda w: wf.Material(1e6, 0.5, 1000), ("poisson_ratio", "between -1 and 0.5")
    ),
    Mistake("nu in per cent", lambda w: wf.Material(210e9, 30, 7850), ("poisson_ratio", "got 30")),
    Mistake("no density", lambda w: Material(210e9, 0.3), ("Material: density must be given",)),
    Mistake("E=", lambda w: Material(E=210e9, nu=0.3, rho=7850), ("no argument 'E'", "youngs_modulus")),
    Mistake("E as text", lambda w: Material("210e9", 0.3, 7850), ("youngs_modulus must be a number, got '210e9'",)),
)

MESHES = (
    Mistake(
        "mm for m",
        lambda w: reduce_roller(mesh=wf.mesh.roller(50, 15, 20, sectors=12, layers=1, axial=1, order=1)),
        ("largest dimension is 100 m", "mm were perhaps read as m"),
    ),
    Mistake("radii swapped", lambda w: wf.mesh.roller(0.015, 0.05, 0.02), ("inner_radius",)),
    Mistake(
        "a file that is not there", lambda w: wf.mesh.read("no.inp", length_unit="mm"), ("'no.inp' does not exist",)
    ),
    Mistake("no unit", lambda w: mesh.read("no.inp"), ("length_unit must be given",)),
    Mistake("unit in words", lambda w: wf.mesh.read("no.inp", length_unit="millimetre"), ("length unit", "'mm'")),
    Mistake("unit=", lambda w: mesh.read("no.inp", lengthunit="mm"), ("did you mean 'length_unit'?",)),
    Mistake(
        "a format nobody reads", lambda w: wf.mesh.read(w.file("a.step", "x"), length_unit="mm"), (".step", ".inp")
    ),
    Mistake(
        "a deck in mm read in m",
        lambda w: wf.mesh.read(w.file("b.inp", BOLT.replace("10", "100")), length_unit="m"),
        ("largest dimension is 100 m", "length unit"),
    ),
    Mistake("a set that is not there", lambda w: roller_mesh().facets("rimm"), ("did you mean 'rim'?",)),
    Mistake(
        "a predicate that is no function",
        lambda w: untyped(roller_mesh()).select("top", "rim", 0.1),
        ("must be a function",),
    ),
    Mistake("a file's name for a mesh", lambda w: reduce("roller.msh", STEEL), ("mesh.read",)),
    Mistake("no material", lambda w: reduce_roller(None), ("material",)),
    Mistake("a negative radius", lambda w: wf.mesh.roller(-0.05, 0.01, 0.02), ("radius must be greater than zero",)),
)

REDUCTIONS = (
    Mistake("max_freqency=", lambda w: reduce_roller(max_freqency=1e4), ("did you mean 'max_frequency'?",)),
    Mistake("kHz for Hz", lambda w: reduce_roller(max_frequency=20), ("no vibration mode", "20 kHz is 20000")),
    Mistake(
        "half-width in mm",
        lambda w: reduce_roller(modes=0, grid=wf.ContactGrid(expected_half_width=0.5)),
        ("rim", "0.5 mm is 0.0005"),
    ),
    Mistake(
        "half-width below the mesh",
        lambda w: reduce_roller(modes=0, grid=wf.ContactGrid(expected_half_width=5e-6)),
        ("times smaller than the facets", "contact_fixed=True"),
    ),
    Mistake("interfaces as a list", lambda w: reduce_roller(interfaces=["bore"]), ('{"bore": "rigid"}',)),
    Mistake(
        "a kind of interface",
        lambda w: reduce_roller(interfaces={"bore": "rigit"}),
        ("'rigit'", "did you mean 'rigid'?"),
    ),
    Mistake("a facet set", lambda w: reduce_roller(interfaces={"bor": "rigid"}), ("did you mean 'bore'?",)),
    Mistake("a shape by its name", lambda w: reduce_roller(contact={"rim": "cylinder"}), ("surfaces.Cylinder()",)),
    Mistake(
        "a shape's class", lambda w: reduce_roller(contact={"rim": wf.surfaces.Cylinder}), ("surfaces.Cylinder()",)
    ),
    Mistake("a plane on a rim", lambda w: reduce_roller(contact={"rim": wf.surfaces.Plane()}), ("contact 'rim'",)),
    Mistake("one set twice", lambda w: reduce_roller(interfaces={"rim": "rigid"}), ("use two sets",)),
    Mistake("a number for the grid", lambda w: reduce_roller(grid=1e-4), ("grid must be a ContactGrid(...)",)),
    Mistake("options of a run", lambda w: reduce_roller(stiffening=True), ("options=wf.ReductionOptions(stiffening=",)),
    Mistake("modes=-1", lambda w: reduce_roller(modes=-1), ("modes must be a whole number of at least 0",)),
    Mistake("modes=True", lambda w: reduce_roller(modes=True), ("leave it out for none",)),
    Mistake(
        "traction='hat'",
        lambda w: reduce_roller(modes=0, grid=ContactGrid(traction="hat")),
        ("traction 'hat' does not exist", "'nodes'"),
    ),
    Mistake(
        "tangential='yes'",
        lambda w: reduce_roller(modes=0, grid=ContactGrid(tangential="yes")),
        ("must be True, False or a kind of functions",),
    ),
    Mistake("basis='craig'", lambda w: reduce_roller(basis="craig"), ("'craig'", "craig_bampton")),
    Mistake("two spacings", lambda w: wf.ContactGrid(spacing=1e-4, expected_half_width=1e-3), ("leave spacing out",)),
    Mistake(
        "20 for 20 GiB",
        lambda w: reduce_roller(modes=0, options=wf.ReductionOptions(periodic=False, memory_limit=20)),
        ("memory_limit",),
    ),
)

MISTAKES = (*MATERIALS, *MESHES, *REDUCTIONS)
