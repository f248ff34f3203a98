"""Names of scripts that were written before the first release, and what they are called since; the next release drops
this table. `errors.suggestion` reads it: of arguments, kinds, words and public names that do not exist."""

from __future__ import annotations

# old -> new, of which one is known where the old one is not; ARGUMENT=... is a new argument that takes the old one
RENAMED: dict[str, tuple[str, ...]] = {
    # surfaces and grids of contact
    "patch_grid": ("contact_fixed",), "patch": ("contact_fixed",), "material": ("body_fixed",),
    "gaps": ("kinematics",), "points": ("closest_point",),
    # runs and studies of runs
    "local": ("local_modes",), "LocalDynamics": ("LocalModes",), "local_dynamics": ("local_modes",),
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
    "law": ("asperities",), "friction": ("boundary_friction",), "form": ("form_a",), "form_second": ("form_b",),
    "roughness": ("roughness_a",), "roughness_second": ("roughness_b",), "powers": ("axial_degrees",),
    "mass_conserving": ("jfo",), "half": ("half_sommerfeld",), "none": ("full_sommerfeld",),
    # laws, forces, cages
    "StribeckCoulomb": ("Stribeck",), "TableCoulomb": ("TabulatedFriction",), "TableLayer": ("TabulatedLayer",),
    "ForceTable": ("TabulatedForce",), "RollingLever": ("RollingResistanceArm",), "Bearing": ("BearingSpring",),
    "stribeck_coulomb": ("stribeck",), "table_coulomb": ("tabulated_friction",), "table_layer": ("tabulated_layer",),
    "force_table": ("tabulated_force",), "rolling_lever": ("rolling_resistance_arm",), "bearing": ("bearing_spring",),
    "Spaced": ("PrescribedCage",), "Pockets": ("PocketCage",), "spaced": ("prescribed_cage",),
    "pockets": ("pocket_cage",),
}  # fmt: skip

STATIC = "; a static run is wf.static(scene, duration, step=...), in a scene file the table [static]"
# (call, old argument) -> what does the same now
REPLACED: dict[tuple[str, str], str] = {
    ("simulate", "kind"): STATIC,
    ("simulate", "record_every"): "; write the recording with wf.record(result, path, every=...), or warpffrf view",
    ("simulate", "keep_every"): "; leave it out, unfinished runs are kept every 20 s",
}  # fmt: skip
