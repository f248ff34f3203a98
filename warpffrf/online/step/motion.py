"""Bodies, modes, rows and loads: their motion and forces, and what a step stores."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.bodies import inertia, interfaces, mean_work, membrane, motion
from warpffrf_kernels.constraints import forces, rows
from warpffrf_kernels.step import accept, local_error, proximal, record, step_control

BEGUN = {"q1": "q", "membrane_slope": "membrane_slope0", "membrane_amplitude": "membrane_amplitude0"}

MOTION = Participant(
    "motion",
    begin=[threads(motion.begin_step)],
    predict=[
        blocks(motion.predict_bodies),
        blocks(motion.predict_modes, when="mode"),
        blocks(membrane.stretch_fibres, when="square", **BEGUN),
        blocks(inertia.shorten_interfaces, when="stiffened_interface", q1="q", slope="slope0"),
        blocks(proximal.open_rounds),
    ],
    move=[
        blocks(motion.move_bodies),
        blocks(motion.hold_motions, when="held_body"),
        blocks(motion.move_modes, when="mode"),
        blocks(inertia.uncondense, when="dense"),
        blocks(inertia.sum_modes, when="inertia_mode"),
        blocks(inertia.add_inertia, when="inertia_mode"),
        blocks(membrane.stretch_fibres, when="square"),
        blocks(membrane.add_membrane_forces, when="square_mode"),
        blocks(inertia.shorten_interfaces, when="stiffened_interface"),
        blocks(interfaces.move_interfaces, when="interface"),
    ],
    load=[
        blocks(rows.apply_forces, when="force"),
        threads(forces.apply_loads, when="load"),
        blocks(rows.evaluate_rows, when="row"),
        blocks(forces.couple_springs, when="group"),
        blocks(mean_work.change_pulls, when="stiffened_interface"),
        blocks(mean_work.add_mean_work, when="mean_mode"),
    ],
    mean=[threads(proximal.end_round)],
    project=[
        blocks(local_error.missed_rates, when="projected_row"),
        blocks(local_error.project_velocities, when="projected_row"),
    ],
    estimate=[threads(local_error.estimate_error, when="adaptive_world")],
    decide=[blocks(step_control.decide)],
    keep=[
        blocks(accept.keep_bodies),
        blocks(accept.keep_modes, when="mode"),
        blocks(local_error.correct_algorithmic, when="projected_row"),
        blocks(mean_work.keep_lags, when="mean_mode"),
        blocks(mean_work.keep_pulls, when="stiffened_interface"),
        blocks(accept.keep_rest),
    ],
    record=[blocks(record.record_motion)],
)
