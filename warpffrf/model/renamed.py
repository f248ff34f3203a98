"""Names of scripts that were written before the first release, and what they are called since; the next release drops
this table. `errors.suggestion` reads it: of arguments, kinds, words and public names that do not exist."""

from __future__ import annotations

# old -> new, of which one is known where the old one is not
RENAMED: dict[str, tuple[str, ...]] = {
    # surfaces and grids of contact
    "patch_grid": ("contact_fixed",), "patch": ("contact_fixed",), "material": ("body_fixed",),
    "gaps": ("kinematics",), "points": ("closest_point",),
    # small sliding
    "Lap": ("Contact",), "LapCells": ("surfaces.Matched",), "laps": ("contact", "contacts"), "lap": ("contact",),
    "lap_cells": ("matched",), "lap_names": ("small_sliding_names",), "lap_page": ("small_sliding_page",),
    "interference": ("sliding",), "tangential_stiffness": ("sliding",),
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
