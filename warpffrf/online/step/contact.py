"""Contact pairs: gaps and forces of the trial state, the local solve, the active set, and impulsive pairs."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.impulsive import impulsive_contact, impulsive_means, impulsive_memory
from warpffrf_kernels.kinematics import (
    at_points,
    closest_point,
    contact_wrench,
    line_of_centres,
    line_of_centres_points,
    windows,
)
from warpffrf_kernels.normal import (
    compliance_reuse,
    contact_assembly,
    contact_compliance,
    contact_fields,
    contact_record,
    contact_solve,
    pair_elimination,
    pressure_solve,
)
from warpffrf_kernels.patch import between, cells, fields, modal_rows, place, spline_tables, strips, system
from warpffrf_kernels.step import missed_contact

NODES_BESIDE = "pair_beside"  # bodies that are loaded by several pairs, some of which have nodes
LINE, POINT = "line_pair", "point_pair"  # families of kinematics
TOUCHING = "patch_beside"  # several of these on one body
MATRIX = "matrix_patch"  # small patches, with a matrix
MATRIX_FREE = "matrix_free_slot"  # large ones, without
PATCH = "patch_pair"  # pressures on contact-fixed cells
GRID_NODES = "node_pair"  # pressures at the nodes of the first grid
STEP = {"amplitude": "modal_step", "of_state": 0, "first_field": "first_step", "second_field": "second_step"}

CONTACT = Participant(
    "contact",
    when="pair",
    begin=[blocks(impulsive_contact.begin_contact), threads(compliance_reuse.begin_rows, when=PATCH)],
    locate=[
        threads(line_of_centres.locate, "pair", when=LINE),
        threads(closest_point.locate_points, "pair", when=POINT),
        threads(place.locate_patches, "pair", when=PATCH),
        threads(windows.open_window, "pair", when=GRID_NODES),
        blocks(line_of_centres_points.sample, "pair", when=LINE),
        blocks(line_of_centres_points.weigh, "pair", when=LINE),
        blocks(contact_wrench.hold_contact_frame, "pair", when=POINT),
        blocks(at_points.sample_points, "pair", when=POINT),
        blocks(at_points.weigh_points, "pair", when=POINT),
        blocks(cells.hold_rows, "pair", when=PATCH),
        blocks(cells.sample_cells, "pair", when=PATCH, weak_gap="shifted_gap"),
        threads(cells.open_far_windows, "pair", when=PATCH),
        blocks(strips.lay_spectrum, "pair", when=PATCH),
        blocks(between.lay_between, "pair", when=TOUCHING),
        blocks(spline_tables.lay_splines, "pair", when=PATCH),
    ],
    shift=[
        blocks(line_of_centres_points.shift, "pair", when=LINE),
        threads(contact_fields.set_second_window, "pair"),
        blocks(contact_fields.modal_fields, "pair", when=GRID_NODES, amplitude="q1", of_state=1),
        blocks(fields.modal_cells, "pair", when=PATCH, amplitude="q1", of_state=1),
    ],
    displace=[
        blocks(contact_fields.load_second, "pair", when=GRID_NODES),
        blocks(contact_fields.local_fields, "pair", when=GRID_NODES),
        blocks(fields.load_splines, "pair", when=PATCH),
        blocks(fields.local_cells, "pair", when=PATCH),
    ],
    close=[
        blocks(contact_fields.close_gaps, "pair"),
        blocks(contact_fields.load_modes, "pair", when=GRID_NODES),
        blocks(fields.load_modes, "pair", when=PATCH),
    ],
    sum=[blocks(contact_fields.sum_contact), threads(fields.guard_patches, when=PATCH)],
    push=[blocks(impulsive_contact.push_bodies)],
    mean=[threads(impulsive_means.balance_means)],
    assemble_compliance=[
        blocks(impulsive_contact.compare_receptances, when="dynamic_mode"),
        blocks(contact_compliance.take_slots),
        threads(compliance_reuse.note_rows, "pair", when=MATRIX),
        blocks(contact_compliance.respond, when=GRID_NODES),
        blocks(contact_compliance.modal_rows, when=GRID_NODES),
        blocks(modal_rows.load_modes_of_cells, "pair", when=PATCH),
        blocks(modal_rows.modal_rows_of_cells, when=PATCH),
        blocks(system.answer_splines, "pair", when=MATRIX),
        blocks(system.assemble_cells, when=MATRIX),
        blocks(contact_assembly.assemble, when=GRID_NODES),
        blocks(contact_assembly.assemble_between, when=NODES_BESIDE),
    ],
    condense=[
        blocks(contact_compliance.retained_rows),
        blocks(pair_elimination.order_slots),
        blocks(pair_elimination.place_cells, "pair", when=PATCH),
    ],
    solve_normal=[
        blocks(pressure_solve.answer_uniform, when=MATRIX_FREE),
        blocks(pair_elimination.eliminate_pairs, "pair"),
        blocks(pressure_solve.pose_pressures),
        blocks(pressure_solve.solve_pressures),
    ],
    back_substitute=[
        blocks(contact_fields.modal_fields, "pair", when=GRID_NODES, **STEP),
        blocks(fields.modal_cells, "pair", when=PATCH, amplitude="modal_step", of_state=0, first_field="first_step"),
    ],
    correct=[blocks(contact_solve.correct_set, "pair"), blocks(contact_solve.accept_set)],
    finish=[blocks(impulsive_memory.finish_rates)],
    judge=[
        blocks(missed_contact.refuse_leaps_of_pairs),
        threads(impulsive_means.judge_pairs, "pair"),
        threads(impulsive_means.find_unsettled, "pair", when="dynamic_mode"),
    ],
    keep=[
        blocks(impulsive_memory.keep_memory, "pair"),
        threads(place.keep_change, "pair", when=PATCH),
        threads(compliance_reuse.keep_rows, when=MATRIX),
    ],
    measure=[
        threads(contact_record.sum_second, "pair", when=LINE),
        threads(at_points.sum_points_second, "pair", when=POINT),
        threads(closest_point.measure_approach, "pair", when=POINT),
        threads(fields.sum_patches_second, "pair", when=PATCH),
        threads(fields.measure_patches, "pair", when=PATCH),
    ],
    record=[blocks(contact_record.record_pairs, "pair"), threads(fields.record_patches, "pair", when=PATCH)],
)
