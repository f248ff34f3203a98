"""Bodies, modes, rows and loads: their motion, their forces, and what a step keeps of them."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.outer import FACTOR
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.bodies import inertia, interfaces, mean_work, membrane, motion
from warpffrf_kernels.constraints import forces, rows
from warpffrf_kernels.step import accuracy, commit, proximal, record

START = {"v_rate": "v_rate0", "v_alg": "v_alg0", "omega_rate": "omega_rate0", "omega_alg": "omega_alg0"}
START_MODES = {"qd_rate": "qd_rate0", "qd_alg": "qd_alg0"}
BEGUN = {"q1": "q", "membrane_slope": "membrane_slope0", "membrane_amplitude": "membrane_amplitude0"}
SUMS, INTERFACES = {"sums": "inertia_sums"}, {"motion": "interface_motion"}

MOTION = Participant(
    "motion",
    begin=[threads(motion.begin_step)],
    predict=[
        blocks(motion.predict_bodies, **START),
        blocks(motion.predict_modes, when="mode", **START_MODES),
        blocks(membrane.stretch_fibres, when="square", **BEGUN),
        blocks(inertia.shorten_interfaces, when="stiffened_interface", q1="q", slope="slope0"),
        blocks(proximal.open_rounds),
    ],
    move=[
        blocks(motion.move_bodies, **START),
        threads(motion.hold_motions, when="held_body"),
        blocks(motion.move_modes, when="mode", **START_MODES),
        blocks(inertia.uncondense, when="dense"),
        blocks(inertia.sum_modes, when="inertia_mode", **SUMS),
        blocks(inertia.add_inertia, when="inertia_mode", **SUMS),
        blocks(membrane.stretch_fibres, when="square"),
        blocks(membrane.add_membrane_forces, when="square_mode"),
        blocks(inertia.shorten_interfaces, when="stiffened_interface"),
        blocks(interfaces.move_interfaces, when="interface", **INTERFACES),
    ],
    load=[
        threads(rows.apply_forces, when="force", **INTERFACES),
        threads(forces.apply_loads, when="load"),
        blocks(rows.evaluate_rows, when="row", **INTERFACES),
        blocks(forces.couple_springs, when="group"),
        blocks(mean_work.change_pulls, when="stiffened_interface"),
        blocks(mean_work.add_mean_work, when="mean_mode"),
    ],
    mean=[threads(proximal.end_round)],
    project=[
        blocks(accuracy.missed_rates, when="projected_row", wanted="project"),
        blocks(
            accuracy.project_velocities,
            when="projected_row",
            wanted="project",
            right="projection_rhs",
            modal_change="modal_step",
            **FACTOR,
        ),  # fmt: skip
    ],
    estimate=[threads(accuracy.estimate_error, when="adaptive_world")],
    decide=[threads(commit.decide, created="created_now")],
    keep=[
        blocks(commit.keep_bodies),
        blocks(commit.keep_modes, when="mode"),
        blocks(accuracy.correct_algorithmic, when="projected_row", wanted="project", modal_change="modal_step"),
        blocks(mean_work.keep_lags, when="mean_mode"),
        blocks(mean_work.keep_pulls, when="stiffened_interface"),
        threads(commit.keep_rest),
    ],
    record=[blocks(record.record_motion)],
)
