"""The friction part of the step graph: slip and tractions of the trial state, and the solve for stick and slip.

Recorded only for scenes with friction. `ContactGraph` calls the parts in the places named; within one Newton iteration
the tractions are solved for after the pressures and their active set have settled, with bodies, modes, joints and the
pressures of that set condensed into them, and in rounds with the bounds, which follow the pressures.
"""

from __future__ import annotations

from typing import Any

import warp as wp
from warpffrf_kernels import (
    friction_advance,
    friction_bounds,
    friction_compliance,
    friction_fields,
    friction_forces,
    friction_geometry,
    friction_keep,
    friction_late,
    friction_normal,
    friction_problem,
    friction_shares,
    friction_solve,
    shared_surface,
)

from warpffrf.online.compile_shared import serves_several
from warpffrf.online.launcher import Launcher

MODULES = (
    friction_geometry, friction_shares, friction_bounds, friction_late, friction_fields, friction_forces,
    friction_compliance, friction_normal, friction_problem, friction_solve, friction_keep, friction_advance,
)  # fmt: skip


class FrictionGraph(Launcher):
    """Records the friction kernels of all contact pairs."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.shared = serves_several(self.compiled.model)

    def place(self) -> None:
        """Cells, after the windows are known: where they are and how far they slide."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.launch(
            friction_geometry.open_cells,
            (W, P),
            [M, x.phase, x.center],
            [s.ctl, x.cell_phase, s.traction, s.friction_offset],
        )
        self.block(
            friction_geometry.place_cells, (W, P),
            [M, s.ctl, x.center, x.window, s.r, s.p, x.r1, x.axes, s.contact_normal],
            [x.cell_area, x.cell_place, x.cell_turn, x.cell_wrench, x.rigid_slip],
        )  # fmt: skip
        self.block(
            friction_shares.spread_cells, (W, P),
            [M, s.ctl, x.center, x.window, x.cell_area, x.cell_place, x.cell_turn], [x.share, x.share_at],
        )  # fmt: skip
        self._bounds(clip=1)
        self.push_gaps()

    def push_gaps(self) -> None:
        """What the present tractions add to the gaps; after `place`."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.block(
            friction_fields.push_gaps, (W, P),
            [M, s.ctl, x.center, x.window, x.second_window, x.cell_area, x.cell_turn, x.share, x.share_at, s.traction],
            [x.second_force, x.first_push, x.second_push],
        )  # fmt: skip
        if self.shared:
            self.block(
                shared_surface.share_push, (W, P),
                [M, s.ctl, x.center, x.window, x.second_window, x.cell_area, s.traction, x.second_force],
                [x.first_push, x.second_push],
            )  # fmt: skip

    def add_push(self) -> None:
        """Adds that to the displacements that open the gaps; after `contact_fields.local_fields`."""
        M, s, x = self.compiled.models, self.state, self.work
        self.block(
            friction_fields.add_push, (self.worlds, self.compiled.model.pair_count),
            [M, s.ctl, x.first_push, x.second_push], [x.first_local, x.second_local],
        )  # fmt: skip

    def slide(self) -> None:
        """Slip of the step, and the loads of the tractions on the modes; before `contact_fields.sum_contact`."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self._press(x.base, x.second_load, of_state=1)
        self.block(
            friction_fields.displace_cells, (W, P),
            [M, s.ctl, x.center, x.window, x.second_window, x.second_force, x.cell_area, x.cell_turn, x.share,
             x.share_at, s.traction, x.q1.flatten()],
            [x.first_shift, x.second_shift, x.second_modal, x.elastic_local, x.elastic],
        )  # fmt: skip
        self.block(
            friction_forces.slide_cells, (W, P),
            [M, s.ctl, x.center, x.window, x.rigid_slip, x.elastic, s.elastic_before, s.history_center], [x.slip],
        )  # fmt: skip
        self.block(
            friction_forces.load_tractions, (W, P),
            [M, s.ctl, x.center, x.window, x.cell_area, s.traction, x.second_force], [s.friction_modal.flatten()],
        )  # fmt: skip

    def add(self) -> None:
        """Friction forces of the pairs; after `contact_fields.sum_contact`."""
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        self.launch(
            friction_forces.add_friction, W,
            [M, s.ctl, s.clk, x.window, x.cell_area, x.cell_wrench, x.bound, x.late, s.traction, x.slip,
             x.elastic_local],
            [x.pair_wrench, x.normal_wrench, x.gap_defect, s.elastic_energy, x.friction_work, x.cell_state,
             x.traction_base],
        )  # fmt: skip

    def solve(self) -> None:
        """Tractions for the pressures just found, where their active set has settled, and the outer increments with
        them."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self._bounds(clip=0)
        self.block(
            friction_fields.change_pressures, (W, P),
            [M, s.ctl, x.window, s.active, s.pressure, x.base, x.stencil, x.stencil_at],
            [x.pressure_change, x.load_change],
        )  # fmt: skip
        self.launch(friction_compliance.take_cells, W, [M, x.bound], [s.ctl, x.cell_slot_of, x.cell_slot])
        shares = [x.cell_area, x.cell_turn, x.share, x.share_at]
        self.block(
            friction_compliance.cell_modes, (W,), [M, s.ctl, x.center, x.cell_slot, *shares, x.weight], [x.cell_J]
        )
        self.block(
            friction_compliance.assemble_cells, (W,),
            [M, s.ctl, x.center, x.second_window, x.cell_slot, *shares, x.cell_J, x.receptance],
            [x.cell_shift, x.cell_scaled, x.cell_G],
        )  # fmt: skip
        self.block(
            friction_compliance.outer_cells, (W,),
            [M, s.ctl, x.axes, x.r1, x.cell_wrench, x.weight, x.cell_slot, x.cell_J, x.C_receptance,
             x.inverse_transposed],
            [x.cell_L, x.cell_V],
        )  # fmt: skip
        self.block(
            friction_normal.answer_tractions, (W,),
            [M, s.ctl, s.active, x.center, x.stencil, x.stencil_at, x.slot_mode, x.order, x.factor, x.J, x.L,
             x.cell_slot, *shares, x.cell_J, x.cell_V, x.receptance],
            [x.second_shift, x.cell_scaled, x.cell_Y, x.answer_hat, x.answer_state],
        )  # fmt: skip
        self.block(
            friction_compliance.condense_cells, (W,),
            [M, s.ctl, x.cell_slot, x.cell_G, x.cell_L, x.cell_V, x.answer_state], [x.cell_K],
        )  # fmt: skip
        self.block(friction_normal.condense_answer, (W,), [M, s.ctl, x.cell_Y, x.answer_state], [x.cell_K])
        self._press(x.pressure_change, x.load_change, of_state=0)
        self.block(
            friction_problem.drive_modes, (W,),
            [M, s.ctl, s.active, x.slot_mode, x.weight, x.J, s.pressure, x.base, x.modal_residual], [x.modal_drive],
        )  # fmt: skip
        self.block(
            friction_problem.pose_tractions, (W,),
            [M, s.ctl, x.cell_slot, x.weight, x.cell_area, s.traction, x.traction_base, x.slip, x.cell_turn, x.share,
             x.share_at, x.first_shift, x.second_shift, x.cell_K, x.cell_L, x.cell_J, x.receptance.flatten(),
             x.modal_drive, x.z],
            [x.cell_base, x.cell_right, x.cell_tau],
        )  # fmt: skip
        x.rubbing.fill_(1)
        wp.capture_while(x.rubbing, self._rub)
        self.block(
            friction_problem.take_tractions, (W,),
            [M, s.ctl, x.cell_slot, x.weight, x.cell_tau, x.cell_base, x.cell_V],
            [x.z, s.traction],
        )  # fmt: skip
        self.block(
            friction_normal.move_with_answer, (W,), [M, s.ctl, x.order, x.answer_state, x.V, x.answer_step], [x.z]
        )

    def _rub(self) -> None:
        """A round of tractions for the present bounds, and of the pressures with their answer."""
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        self.block(
            friction_problem.limit_tractions, (W,),
            [M, s.ctl, s.clk, x.cell_slot, x.weight, x.cell_area, x.bound, x.late, x.answer_state],
            [x.cell_radius, x.cell_softness],
        )  # fmt: skip
        self.block(
            friction_solve.solve_tractions, (W,),
            [M, x.cell_K, x.cell_right, x.cell_radius, x.cell_softness],
            [s.ctl, x.cell_tau, x.cell_slip, x.cell_jump, x.cell_direction, x.cell_frozen, x.cell_curvature,
             x.cell_order, x.cell_sliding, x.cell_outcome, x.cell_solution, x.cell_work],
        )  # fmt: skip
        self.block(
            friction_normal.press_with_tractions, (W,),
            [M, s.ctl, x.slot_mode, x.order, x.factor, x.solution, x.cell_Y, x.weight, x.cell_tau, x.cell_base, x.base],
            [x.answer_step, s.pressure, x.answer_change, x.answer_state],
        )  # fmt: skip
        self._bounds(clip=0)
        self.launch(friction_normal.count_rounds, 1, [s.ctl, x.answer_state], [x.rubbing])

    def push_modes(self) -> None:
        """Increments of the modes by the tractions; after `contact_solve.modal_increments`."""
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        self.block(
            friction_problem.push_modes, (W,),
            [M, s.ctl, x.cell_slot, x.cell_tau, x.cell_base, x.cell_J, x.receptance], [x.cell_push, x.modal_step],
        )  # fmt: skip

    def remember(self) -> None:
        """The tractions before an attempt."""
        s, x = self.state, self.work
        self.block(
            friction_keep.remember_tractions, (self.worlds, self.compiled.model.pair_count),
            [s.ctl, s.traction, s.friction_offset], [x.traction_before, x.friction_offset_before],
        )  # fmt: skip

    def keep(self) -> None:
        """After the decision: the history of an accepted step, or the tractions as they were."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.launch(
            friction_advance.follow_patch, (W, P),
            [M, s.ctl, x.r1, x.axes, x.phase, x.nearest], [s.history_phase, s.history_z, s.most_advanced, x.advanced],
        )  # fmt: skip
        self.block(
            friction_keep.keep_tractions, (W, P),
            [M, s.ctl, s.clk, s.history_phase, x.advanced, x.center, x.window, x.elastic, x.rigid_slip, x.friction_work,
             x.normal_wrench, x.traction_before, x.friction_offset_before],
            [s.traction, s.friction_offset, s.elastic_before, s.history_center, s.contact_normal,
             x.friction_record],
        )  # fmt: skip
        self.block(friction_late.keep_pressed, (W, P), [M, s.ctl, x.window, s.active, s.pressure], [s.pressed_before])

    def record(self) -> None:
        """Write the accepted tractions to the end of the ring's row; before `record.record`, which counts it."""
        M, s, x = self.compiled.models, self.state, self.work
        self.block(
            friction_keep.record_friction, (self.worlds, self.compiled.model.pair_count),
            [M, s.ctl, s.clk, s.traction, x.slip, x.bound, x.cell_state, x.friction_record, x.pair_wrench,
             x.normal_wrench],
            [s.most_advanced, x.second_wrench, x.ring],
        )  # fmt: skip

    def _press(self, pressure: Any, load: Any, of_state: int) -> None:
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.block(
            friction_fields.press_cells, (W, P), [M, s.ctl, x.center, x.window, pressure, load, of_state],
            [x.first_shift, x.second_shift],
        )  # fmt: skip
        if self.shared:
            self.block(
                shared_surface.share_shift, (W, P),
                [M, s.ctl, x.center, x.window, pressure, load, x.cell_area, s.traction, x.second_force, of_state],
                [x.first_shift, x.second_shift],
            )  # fmt: skip

    def _bounds(self, clip: int) -> None:
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        loads = [x.window, s.active, s.pressure, x.cell_area, x.area]
        self.block(friction_bounds.bound_cells, (W, P), [M, s.ctl, *loads, clip], [x.bound, s.traction])
        self.block(
            friction_late.soften_late, (W, P),
            [M, s.ctl, x.center, x.phase, x.nearest, s.history_center, s.history_phase, s.contact_normal,
             s.pressed_before, *loads, x.share, x.share_at, clip, x.bound],
            [x.late],
        )  # fmt: skip
