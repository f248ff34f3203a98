"""Names from before the first release and their present names; the next release drops this table.
`errors.suggestion` reads it: of arguments, kinds, words and public names that do not exist."""

from __future__ import annotations

# old -> new, of which one is known where the old one is not; ARGUMENT=... is a new argument that takes the old one
RENAMED: dict[str, tuple[str, ...]] = {
    # surfaces and grids of contact
    "patch_grid": ("contact_fixed",),
    "patch": ("contact_fixed",), "material": ("body_fixed", "materials"),
    "gaps": ("kinematics",), "points": ("closest_point",),
    "evaluation": ("quadrature",), "semi": ("full",), "hyper": ("reduced",),
    # small sliding
    "Lap": ("Contact",), "LapCells": ("surfaces.Matched",), "laps": ("contact", "contacts"), "lap": ("contact",),
    "lap_cells": ("matched",), "lap_names": ("small_sliding_names",), "lap_page": ("small_sliding_page",),
    "interference": ("sliding",), "tangential_stiffness": ("sliding",),
    # runs and studies of runs
    "GeneralizedAlpha": ("integrators.GeneralizedAlpha",),
    "local": ("local_modes",), "LocalDynamics": ("LocalModes",),
    "local_dynamics": ("local_modes",),
    "stages": ("duration",), "device": ("workers=['cuda:0', ...]",),
    "simulate": ("run=functools.partial(wf.simulate, ...)",), "equilibrium": ("run=wf.equilibrium",),
    **{name: (f"run=functools.partial(wf.simulate, {name}=...)",) for name in ("duration", "step", "start")},
    "seed": ("sample='latin:64:SEED'",), "client": ("workers=...",), "error_budget": ("outputs=['error_budget', ...]",),
    "settings": ("parameters=...",),
    # oil films
    "Groove": ("AxialGroove",), "Ring": ("CircumferentialGroove",), "Hole": ("SupplyHole",),
    "oil_groove": ("axial_groove",), "oil_ring": ("circumferential_groove",), "oil_hole": ("supply_hole",),
    "Lobes": ("LobedForm",), "Barrel": ("BarrelForm",), "Worn": ("WornForm",), "Measured": ("MeasuredForm",),
    "Sum": ("CompositeForm",), "lobes": ("lobed_form",), "barrel": ("barrel_form",), "worn": ("worn_form",),
    "measured": ("measured_form",), "sum": ("composite_form",),
    "law": (
        "asperities", "mixed=wf.films.MixedLubrication(asperities=...)", "contact=wf.bearings.RollingContact(law=...)",
    ),
    "friction": (
        "boundary_friction", "mixed=wf.films.MixedLubrication(boundary_friction=...)",
        "contact=wf.bearings.RollingContact(friction=...)",
    ),
    "roughness": ("roughness_a", "mixed=wf.films.MixedLubrication(roughness_a=...)"),
    "roughness_second": ("roughness_b", "mixed=wf.films.MixedLubrication(roughness_b=...)"),
    "form": ("form_a",), "form_second": ("form_b",),
    **{name: (f"mixed=wf.films.MixedLubrication({name}=...)",)
       for name in ("asperities", "boundary_friction", "roughness_a", "roughness_b")},
    "powers": ("axial_degrees",),
    "mass_conserving": ("jfo",), "half": ("half_sommerfeld",), "none": ("full_sommerfeld",),
    # reductions
    "hats": ("nodes",), "traction_spacing": ("spacing",), "contact_error": ("force_error",),
    # laws, forces, cages
    "StribeckCoulomb": ("Stribeck",), "TableCoulomb": ("TabulatedFriction",), "TableLayer": ("TabulatedLayer",),
    "ForceTable": ("TabulatedForce",), "RollingLever": ("RollingResistanceArm",), "Bearing": ("BearingSpring",),
    "stribeck_coulomb": ("stribeck",), "table_coulomb": ("tabulated_friction",), "table_layer": ("tabulated_layer",),
    "force_table": ("tabulated_force",), "rolling_lever": ("rolling_resistance_arm",), "bearing": ("bearing_spring",),
    "Spaced": ("PrescribedCage",), "Pockets": ("PocketCage",), "spaced": ("prescribed_cage",),
    "pockets": ("pocket_cage",),
    # preload: a tension, of bolts and springs; friction in a joint without load, and the axial preload of a bearing
    "preload": ("load_independent", "axial_preload"), "Preload": ("AxialPreload",), "force": ("preload",),
    # bearings
    **dict.fromkeys(
        ("elements", "pitch_diameter", "clearance", "inner_form", "outer_form", "diameter_deviations", "width", "bore",
         "outside_diameter"), ("geometry=wf.bearings.BallGeometry(...) or RollerGeometry(...)",)
    ),
    **{name: (f"geometry=wf.bearings.BallGeometry({name}=...)",)
       for name in ("ball_diameter", "osculation", "contact_angle", "shoulders")},
    **{name: (f"geometry=wf.bearings.RollerGeometry({name}=...)",)
       for name in ("roller_diameter", "roller_length", "profile")},
    **{name: (f"materials=wf.bearings.Materials({name}=...)",) for name in ("element_material", "element_body")},
    **{name: (f"contact=wf.bearings.RollingContact({name}=...)",) for name in ("rolling_resistance", "spin")},
}  # fmt: skip

STATIC = "; a static run is wf.static(scene, duration, step=...), in a scene file the table [static]"
# (call, old argument) -> what does the same now
REPLACED: dict[tuple[str, str], str] = {
    ("simulate", "kind"): STATIC,
    ("simulate", "record_every"): "; write the recording with wf.record(result, path, every=...), or warpffrf view",
    ("simulate", "keep_every"): "; leave it out, unfinished runs are kept every 20 s",
}  # fmt: skip
