"""Table of all quantities of a results file and an xarray dataset: one row per quantity, one name everywhere.

A quantity is stacked over its owners (`contact_force (time, pair, axis)`) if its shape is the same for all of them;
otherwise there is one array per owner (`contact_pressure/<pair> (time, column, row)`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class Field:
    """One stored quantity: public name, attribute of the history record, unit, frame, dimensions after `time`,
    and whether its owners are stacked."""

    name: str
    attribute: str
    units: str
    frame: str
    dims: tuple[str, ...] = ()
    stacked: bool = True


WORLD = "world"
USER_ORIGIN = "world, about the origin of the body's user frame"
AXIS, QUATERNION = ("axis",), ("quaternion",)
DIRECTION = ("direction",)  # e_theta and t_z of the first surface
CHART_AXIS = ("chart_axis",)  # e_0 and e_1 of the first surface
# Labels of the entries along dimensions that are the same for all owners.
COMPONENTS = {
    "axis": ("x", "y", "z"),
    "quaternion": ("x", "y", "z", "w"),
    "direction": ("e_theta", "t_z"),
    "slip": ("along", "around"),
    "chart_axis": ("e_0", "e_1"),
    "along": ("t_1", "t_2"),
    "frame_axis": ("n", "t_1", "t_2"),
    "side": ("contact", "second_face"),
}
SIZES = {dim: len(names) for dim, names in COMPONENTS.items()}

RUN_FIELDS = (
    Field("time", "time", "s", "none"),
    Field("step_size", "step_size", "s", "none"),
    Field("iterations", "iterations", "1", "none"),
    Field("factorisations", "factorisations", "1", "none"),
)

BODY_FIELDS = (
    Field("body_position", "position", "m", "world, origin of the body's user frame", AXIS),
    Field("body_rotation", "rotation", "1", "user frame to world, quaternion x y z w", QUATERNION),
    Field("body_velocity", "velocity", "m/s", "world, of the origin of the body's user frame", AXIS),
    Field("body_angular_velocity", "angular_velocity", "rad/s", WORLD, AXIS),
    Field("body_modal", "modal", "kg^0.5 m", "modal coordinates of the body", ("mode",), stacked=False),
    Field("body_acceleration", "acceleration", "m/s2", "world, of the origin of the body's user frame", AXIS),
    Field("body_angular_acceleration", "angular_acceleration", "rad/s2", WORLD, AXIS),
    Field("body_modal_velocity", "modal_velocity", "kg^0.5 m/s", "none", ("mode",), stacked=False),
    Field("body_modal_acceleration", "modal_acceleration", "kg^0.5 m/s2", "none", ("mode",), stacked=False),
)

JOINT_FIELDS = (
    Field("joint_coordinate", "coordinate", "rad or m", "joint"),
    Field("joint_second_coordinate", "second_coordinate", "rad or m", "joint"),
    Field("joint_force", "force", "N", "world, on the second body", AXIS),
    Field("joint_torque", "torque", "N m", "world, on the second body, about the joint point", AXIS),
)

FORCE_FIELDS = (
    Field("applied_force", "force", "N", "world, on the loaded or the second body", AXIS),
    Field("applied_torque", "torque", "N m", "world, about the port or the user origin, see ForceHistory", AXIS),
    Field("applied_deformation", "deformation", "m or rad", "axes of the first port", ("coordinate",), stacked=False),
)

# Force elements that model friction in a joint: dimension `joint_friction`.
JOINT_FRICTION_FIELDS = (
    Field("joint_friction_state", "state", "1 stick, 2 slip", "none"),
    Field("joint_slip_velocity", "slip_velocity", "m/s", "axis of the joint: along, around", ("slip",)),
    Field("joint_traction", "traction", "N", "axis of the joint: along, around; on the second body", ("slip",)),
    Field("joint_friction_bound", "bound", "N", "none"),
    Field("joint_friction_power", "power", "W", "dissipated"),
)

CONTACT_FIELDS = (
    Field("contact_force", "force", "N", "world, on the first body", AXIS),
    Field("contact_torque", "torque", "N m", f"{USER_ORIGIN}, on the first body", AXIS),
    Field("contact_force_second", "force_second", "N", "world, on the second body", AXIS),
    Field("contact_torque_second", "torque_second", "N m", f"{USER_ORIGIN}, on the second body", AXIS),
    Field("contact_approach", "approach", "m", "along the line of centres"),
    Field("contact_active_nodes", "active_nodes", "1", "none"),
    Field("contact_first_column", "first_column", "1", "contact grid of the first surface"),
    Field("contact_center_column", "center_column", "1", "contact grid of the first surface"),
    Field("contact_first_column_second", "first_column_second", "1", "contact grid of the second surface"),
    Field("contact_pressure", "pressure", "Pa", "contact grid of the first surface", ("column", "row"), stacked=False),
    Field(
        "contact_load_second",
        "load_second",
        "N",
        "contact grid of the second surface, positive inwards",
        ("column", "row"),
        stacked=False,
    ),
)

# Contacts whose pressure is constant on cells that move with the patch: dimension `cell_pair`.
CELL_FRAME = "first surface, along its axis"
TRAVELLING = "cells that travel with the patch: equal strips across, rows along the axis of the first surface"
CELL_FIELDS = (
    Field("contact_cell_column", "column", "1", "contact grid of the first surface, middle of the patch"),
    Field("contact_cell_column_second", "column_second", "1", "contact grid of the second surface, opposite"),
    Field("contact_cell_row_shift", "row_shift", "1", "first surface, middles of the rows", ("row",), stacked=False),
    Field("contact_cell_half_width", "half_width", "m", "first surface, arc over which strips are to either side"),
    Field("contact_cell_z", "z", "m", f"{CELL_FRAME}, middles of the rows", ("row",), stacked=False),
    Field("contact_cell_length", "length", "m", f"{CELL_FRAME}, lengths of the rows", ("row",), stacked=False),
)

LUMPED_FIELDS = (
    Field("lumped_force", "force", "N", "world, on the first body", AXIS),
    Field("lumped_torque", "torque", "N m", f"{USER_ORIGIN}, on the first body", AXIS),
    Field("lumped_place", "place", "m", WORLD, AXIS),
    Field("lumped_approach", "approach", "m", "of the undeformed surfaces, negative where apart"),
    Field("lumped_normal_force", "normal_force", "N", "along the normal"),
    Field("lumped_friction_force", "friction_force", "N", "world, on the first body", AXIS),
    Field("lumped_slip_velocity", "slip_velocity", "m/s", "world, of the first surface against the second", AXIS),
    Field("lumped_lamina_force", "lamina_force", "N", "along the normals", ("lamina",), stacked=False),
    Field("lumped_moment", "moment", "N m", "world, on the first body, against rolling and pivoting", AXIS),
)

FILM_GRID = "contact grid of the first surface"
FILM_NODES = ("film_column", "film_row")
FILM_FIELDS = (
    Field("film_force", "force", "N", "world, on the first body", AXIS),
    Field("film_torque", "torque", "N m", f"{USER_ORIGIN}, on the first body", AXIS),
    Field("film_torque_second", "torque_second", "N m", f"{USER_ORIGIN}, on the second body", AXIS),
    Field("film_smallest_gap", "smallest_gap", "m", "at a point of the film"),
    Field("film_largest_pressure", "largest_pressure", "Pa", "first surface"),
    Field("film_pressure_loss", "pressure_loss", "W", "taken by flow under pressure, voids that close and feeds"),
    Field("film_friction_power", "friction_power", "W", "taken by sliding"),
    Field("film_feed_flow", "feed_flow", "m3/s", "in through feeds"),
    Field("film_end_flow", "end_flow", "m3/s", "out at the ends"),
    Field("film_void_fraction", "void_fraction", "1", "of the volume of the gap"),
    Field("film_oil_volume", "oil_volume", "m3", "in the film, as of the density without pressure"),
    Field("film_asperity_force", "asperity_force", "N", "along the normals, without regard to their direction"),
    Field("film_largest_asperity_pressure", "largest_asperity_pressure", "Pa", "of asperities, without the oil"),
    Field("film_eccentricity", "eccentricity", "m", "inner against outer axis, e_0 and e_1 of the first", CHART_AXIS),
    Field("film_pressure", "pressure", "Pa", FILM_GRID, FILM_NODES, stacked=False),
    Field("film_gap", "gap", "m", FILM_GRID, FILM_NODES, stacked=False),
    Field("film_void", "void", "m", f"{FILM_GRID}, volume per area", FILM_NODES, stacked=False),
    Field("film_asperity", "asperity", "Pa", f"{FILM_GRID}, of asperities, without the oil", FILM_NODES, stacked=False),
)
FILM_SECOND_FIELDS = (
    Field(
        "film_load_second", "load_second", "N", "contact grid of the second surface, inwards", FILM_NODES, stacked=False
    ),
)
FILM_HEAT_FIELDS = (
    Field("film_inlet_temperature", "inlet_temperature", "degC", "of oil that enters at feeds and leading edges"),
    Field("film_heat_generated", "heat_generated", "W", "by sliding, flow, closing cavities and asperities"),
    Field("film_heat_carried", "heat_carried", "W", "by oil that leaves, less that of oil entering, above the supply"),
    Field("film_heat_to_a", "heat_to_a", "W", "conducted into the first surface"),
    Field("film_heat_to_b", "heat_to_b", "W", "conducted into the second surface"),
    Field("film_heat_stored", "heat_stored", "W", "by the oil in the film"),
    Field("film_temperature", "temperature", "degC", f"{FILM_GRID}, mean across the gap", FILM_NODES, stacked=False),
)

MATCHED_CELL = "small_sliding_cell"
ON_CELLS, ALONG_CELLS = (MATCHED_CELL,), (MATCHED_CELL, "along")  # along: t_1 and t_2 of the frame of a cell
OF_CELLS = "along t_1 and t_2 of the cells"
SMALL_SLIDING_FIELDS = (
    Field("small_sliding_force", "force", "N", "world, on the first body", AXIS),
    Field("small_sliding_torque", "torque", "N m", "world, on the first body, about its user origin", AXIS),
    Field("small_sliding_normal_force", "normal_force", "N", "along the normals, without regard to their direction"),
    Field("small_sliding_pressure", "pressure", "Pa", "means over the cells", ON_CELLS, stacked=False),
    Field("small_sliding_traction", "traction", "Pa", f"on the first face, {OF_CELLS}", ALONG_CELLS, stacked=False),
    Field("small_sliding_gap", "gap", "m", "along the normals", ON_CELLS, stacked=False),
    Field("small_sliding_slip", "slip", "m", f"first relative to second, {OF_CELLS}", ALONG_CELLS, stacked=False),
    Field("small_sliding_state", "state", "0 open, 1 stick, 2 slip", "none", ON_CELLS, stacked=False),
    Field("small_sliding_cell_loss", "loss", "J", "by friction so far", ON_CELLS, stacked=False),
)  # fmt: skip
# Derived by `SmallSlidingResult`, written for readers without warpffrf, not read back.
FIRST_USER = "user frame of the first body"
SMALL_SLIDING_DERIVED = (
    Field("small_sliding_loss", "loss", "J", "by friction so far"),
    Field("small_sliding_peak_pressure", "peak_pressure", "Pa", "mean over a cell"),
    Field("small_sliding_peak_position", "peak_position", "m", f"{FIRST_USER}, cell of the largest pressure", AXIS),
    Field("small_sliding_stick_area", "stick_area", "m2", "none"),
    Field("small_sliding_slip_area", "slip_area", "m2", "none"),
    Field("small_sliding_slip_share", "slip_share", "1", "of the area under pressure"),
    Field(
        "small_sliding_sliding", "sliding", "m", f"{FIRST_USER}, of the second face at the middle of the cells", AXIS
    ),
    Field("small_sliding_turning", "turning", "rad", f"{FIRST_USER}, of the second face", AXIS),
)
# Of `SmallSlidingView`: the cells, the same in all steps.
SMALL_SLIDING_CELLS = (
    Field("small_sliding_number", "cell", "1", "number of the cell on the first face", ON_CELLS, stacked=False),
    Field("small_sliding_point", "points", "m", f"{FIRST_USER}, middles of the cells", (MATCHED_CELL, "axis"), False),
    Field(
        "small_sliding_frame", "frames", "1", f"{FIRST_USER}, rows n, t_1, t_2", (MATCHED_CELL, "frame_axis", "axis"),
        False,
    ),
    Field("small_sliding_area", "area", "m2", "none", ON_CELLS, stacked=False),
    Field(
        "small_sliding_partner", "partners", "m", "user frame of the second body, likewise", (MATCHED_CELL, "axis"),
        False,
    ),
    Field(
        "small_sliding_partner_frame", "partner_frames", "1", "second body, likewise",
        (MATCHED_CELL, "frame_axis", "axis"), False,
    ),
    Field(
        "small_sliding_share", "shares", "1", "of the force of a cell on one of a second flexible face", ("share",),
        False,
    ),
    Field("small_sliding_share_cell", "share_cells", "1", "numbers of both cells", ("share", "side"), False),
)  # fmt: skip

# Contacts with friction: dimension `friction_pair`.
CELLS = "cells of the contact grid of the first surface"
COUNTED = "first surface, counted in cells"
CREEP = "first surface: longitudinal (e_theta), lateral (t_z), at the patch centre"
NORMAL = "about the outward normal of the first surface, at the patch centre"
FIRST = "first surface, along e_theta and t_z"
FRICTION_FIELDS = (
    Field("contact_traction", "traction", "Pa", f"{FIRST}, on the first body", (*DIRECTION, "column", "row"), False),
    Field(
        "contact_slip_velocity",
        "slip_velocity",
        "m/s",
        f"{FIRST}, of the first relative to the second",
        (*DIRECTION, "column", "row"),
        stacked=False,
    ),
    Field("contact_state", "state", "0 open, 1 stick, 2 slip", CELLS, ("column", "row"), stacked=False),
    Field("contact_friction_power", "power", "W", "dissipated"),
    Field("contact_creep_velocity", "creep_velocity", "m/s", f"{FIRST}, in the cell at the patch centre", DIRECTION),
    Field("contact_rolling_velocity", "rolling_velocity", "m/s", "first surface, along e_theta"),
    Field("contact_cells_per_step", "cells_per_step", "1", "columns of cells, most since the last saved row"),
)

# Derived by `ContactResult`, written for readers without warpffrf, not read back.
DERIVED_FIELDS = (
    Field("contact_half_width", "half_width", "m", "first surface, at mid-width"),
    Field("contact_peak_pressure", "peak_pressure", "Pa", "first surface"),
    Field("contact_peak_position", "peak_position", "m", f"{FIRST_USER}, of the largest pressure", AXIS),
    Field("contact_line_load", "line_load", "N/m", "first surface, at mid-width"),
    Field("contact_normal_load", "normal_load", "N", "integral of the pressure over the first surface"),
    Field("contact_half_widths", "half_widths", "m", FIRST, DIRECTION),
    Field("contact_center", "center_of_pressure", "m", "first surface: arc from the line of centres, z", DIRECTION),
    Field("contact_patch_area", "patch_area", "m2", COUNTED),
)
# Derived by `FrictionResult`.
FRICTION_DERIVED = (
    Field("contact_creepage", "creepage", "1", CREEP, DIRECTION),
    Field("contact_spin_creepage", "spin_creepage", "rad/m", NORMAL),
    Field("contact_spin_velocity", "spin_velocity", "rad/s", f"{NORMAL}, of the first body against the second"),
    Field("contact_tangential_force", "tangential_force", "N", f"{FIRST} (Fx, Fy), on the first body", DIRECTION),
    Field("contact_spin_moment", "spin_moment", "N m", f"{NORMAL} (Mz), of the tractions on the first body"),
    Field("contact_t_gamma", "t_gamma", "N", "dissipated per metre rolled, by forces and creepages"),
    Field("contact_traction_coefficient", "traction_coefficient", "1", "none"),
    Field("contact_stick_area", "stick_area", "m2", COUNTED),
    Field("contact_slip_area", "slip_area", "m2", COUNTED),
    Field("contact_slip_share", "slip_share", "1", "of the loaded area"),
    Field("contact_wear_rate", "wear_rate", "W", "pressure times slip speed over the patch"),
    Field("contact_wear_peak", "wear_peak", "W/m2", "pressure times slip speed, largest"),
    Field("contact_wear_index", "wear_index", "W/m2", CELLS, ("column", "row"), stacked=False),
)
DERIVED_POSITIONS = (
    Field("contact_pressure_theta", "theta", "rad", "chart of the first surface", ("column",), stacked=False),
    Field("contact_pressure_arc", "arc", "m", "first surface, from the line of centres", ("column",), stacked=False),
)
# Derived by `FilmResult`: coordinates of the nodes, the same in all steps.
FILM_POSITIONS = (
    Field("film_theta", "theta", "rad, of a plane m", "chart of the first surface", ("film_column",), stacked=False),
    Field("film_z", "z", "m", "along the axis of the first surface", ("film_row",), stacked=False),
)
ENERGY_UNITS = "J"


def of_owner(field: Field, owner: Any) -> Field:
    """The quantity for this owner: pressure and friction of a contact may be given on cells of its own."""
    if field.name == "contact_pressure" and getattr(owner, "cells", None) is not None:
        return replace(field, frame=TRAVELLING)
    if field.frame == CELLS and getattr(getattr(owner, "contact", None), "loaded", "") == "cells":
        return replace(field, frame=TRAVELLING)
    return field
