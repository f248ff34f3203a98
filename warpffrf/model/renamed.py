"""Names of scripts that were written before the first release, and what they are called since; the next release drops
this table. `errors.suggestion` reads it: of arguments, kinds, words and public names that do not exist.

An argument that belongs to an option object now stands with the argument for that object, `geometry=BallGeometry(...)`.
"""

from __future__ import annotations

# old -> new, of which one, or its part before "=", is known where the old one is not
RENAMED: dict[str, tuple[str, ...]] = {
    # surfaces and grids of contact
    "patch_grid": ("contact_fixed",), "patch": ("contact_fixed",), "material": ("body_fixed", "materials"),
    "gaps": ("kinematics",), "points": ("closest_point",),
    # oil films
    "Groove": ("AxialGroove",), "Ring": ("CircumferentialGroove",), "Hole": ("SupplyHole",),
    "oil_groove": ("axial_groove",), "oil_ring": ("circumferential_groove",), "oil_hole": ("supply_hole",),
    "Lobes": ("LobedForm",), "Barrel": ("BarrelForm",), "Worn": ("WornForm",), "Measured": ("MeasuredForm",),
    "Sum": ("CompositeForm",), "lobes": ("lobed_form",), "barrel": ("barrel_form",), "worn": ("worn_form",),
    "measured": ("measured_form",), "sum": ("composite_form",),
    "law": ("asperities", "contact=RollingContact(...)"),
    "friction": ("boundary_friction", "contact=RollingContact(...)"), "form": ("form_a",), "form_second": ("form_b",),
    "roughness": ("roughness_a",), "roughness_second": ("roughness_b",), "powers": ("axial_degrees",),
    "mass_conserving": ("jfo",), "half": ("half_sommerfeld",), "none": ("full_sommerfeld",),
    # laws, forces, cages
    "StribeckCoulomb": ("Stribeck",), "TableCoulomb": ("TabulatedFriction",), "TableLayer": ("TabulatedLayer",),
    "ForceTable": ("TabulatedForce",), "RollingLever": ("RollingResistanceArm",), "Bearing": ("BearingSpring",),
    "stribeck_coulomb": ("stribeck",), "table_coulomb": ("tabulated_friction",), "table_layer": ("tabulated_layer",),
    "force_table": ("tabulated_force",), "rolling_lever": ("rolling_resistance_arm",), "bearing": ("bearing_spring",),
    "Spaced": ("PrescribedCage",), "Pockets": ("PocketCage",), "spaced": ("prescribed_cage",),
    "pockets": ("pocket_cage",),
    # preload: a tension, of bolts and springs; friction in a joint without load, and the axial preload of a bearing
    "preload": ("load_independent", "axial_preload"), "Preload": ("AxialPreload",), "force": ("preload",),
    # arguments that an option object has now
    **dict.fromkeys(
        ("elements", "pitch_diameter", "clearance", "inner_form", "outer_form", "diameter_deviations", "width", "bore",
         "outside_diameter"), ("geometry=BallGeometry(...) or RollerGeometry(...)",)
    ),
    **dict.fromkeys(
        ("ball_diameter", "osculation", "contact_angle", "shoulders"), ("geometry=BallGeometry(...)",)
    ),
    **dict.fromkeys(("roller_diameter", "roller_length", "profile"), ("geometry=RollerGeometry(...)",)),
    **dict.fromkeys(("element_material", "element_body"), ("materials=Materials(...)",)),
    **dict.fromkeys(("rolling_resistance", "spin"), ("contact=RollingContact(...)",)),
}  # fmt: skip
