"""The step as a graph: recorded once, replayed until a chunk of steps is done.

One attempt of a step is: begin, predict, the Newton loop (evaluate, is it balanced? condense, contact, advance),
ledger, decision, copy, record. A scene without contact pairs records no contact kernel. Nothing here runs on the host
while a graph replays.
"""

from __future__ import annotations

from typing import Any

import warp as wp
from warpffrf_kernels import (
    accuracy,
    commit,
    contact_compliance,
    contact_fields,
    contact_geometry,
    contact_solve,
    forces,
    inertia,
    ledger,
    motion,
    outer,
    record,
    rows,
    sparse_outer,
    stiffen,
)
from warpffrf_kernels.scalars import BLOCK

from warpffrf.online.compile import CompiledScene
from warpffrf.online.outer_pattern import on_device, pattern_of
from warpffrf.online.state import State, Work


class StepGraph:
    """Records the loop over attempts on a device; `replay(budget)` runs it."""

    def __init__(
        self,
        compiled: CompiledScene,
        state: State,
        work: Work,
        worlds: int,
        *,
        projected: bool = False,
        adaptive: bool = False,
    ) -> None:
        self.compiled, self.state, self.work, self.worlds = compiled, state, work, worlds
        self.projected, self.adaptive = projected and compiled.model.row_count > 0, adaptive
        self.device = compiled.device
        # None: the outer matrix is inverted, as contact and the projection of velocities need it
        self.pattern = None if self.projected else pattern_of(compiled)
        if self.pattern is not None:
            work.make_room(self.pattern, worlds, self.device)
            self.pattern_struct, self.patterns = on_device(self.pattern, self.device)
        self._load_modules()
        with wp.ScopedCapture(device=self.device) as capture:
            wp.capture_while(work.more, self._attempt)
        self.graph: Any = capture.graph

    def replay(self, budget: int) -> None:
        """Attempt steps until every world has reached its target or failed, at most `budget` times."""
        self.work.budget.fill_(budget + 1)
        self._launch(commit.count_attempts, 1, [self.state.ctl], [self.work.budget, self.work.more])
        wp.capture_launch(self.graph)
        if wp.get_device(self.device).is_cuda:
            wp.synchronize_device(self.device)

    # --- recording

    def _load_modules(self) -> None:
        """Compile before the capture: modules cannot be loaded inside one."""
        for module in (
            accuracy,
            motion,
            rows,
            forces,
            inertia,
            outer,
            sparse_outer,
            stiffen,
            commit,
            ledger,
            record,
            contact_geometry,
            contact_compliance,
            contact_fields,
            contact_solve,
        ):
            wp.load_module(module, device=self.device, block_dim=BLOCK)
            wp.load_module(module, device=self.device)

    def _launch(self, kernel: Any, dim: Any, inputs: list, outputs: list) -> None:
        wp.launch(kernel, dim=dim, inputs=inputs, outputs=outputs, device=self.device)

    def _block(self, kernel: Any, dim: Any, inputs: list, outputs: list) -> None:
        """One block of lanes per index."""
        wp.launch_tiled(kernel, dim=dim, inputs=inputs, outputs=outputs, block_dim=BLOCK, device=self.device)

    def _attempt(self) -> None:
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        Q, P = m.modal_count, m.pair_count
        self._launch(motion.begin_step, W, [x.coefficients, x.local_coefficients], [s.ctl, s.clk])
        self._block(
            motion.predict_bodies, (W,),
            [s.ctl, s.clk, s.v, s.v_rate, s.v_alg, s.omega, s.omega_rate, s.omega_alg], [x.dx, x.psi],
        )  # fmt: skip
        if Q:
            self._block(
                motion.predict_modes, (W,), [M, s.ctl, s.clk, s.q, s.qd, s.qd_rate, s.qd_alg, s.modal_load], [x.dq]
            )
        if P:
            before = [x.active_before, x.pressure_before, x.offset_before]
            self._block(commit.remember_contact, (W, P), [s.ctl, s.active, s.pressure, s.patch_offset], before)
        x.running.fill_(1)
        wp.capture_while(x.running, self._iteration)
        if self.projected:
            self._project_velocities()
        if self.adaptive:
            self._launch(
                accuracy.estimate_error, W,
                [M, s.ctl, x.accuracy, s.v_rate, x.v1_rate, s.omega_rate, x.omega1_rate, s.qd_rate, x.qd1_rate],
                [s.clk],
            )  # fmt: skip
        if P:
            self._launch(ledger.generalise_contact, (W, P), [M, s.ctl, x.r1, x.axes, x.pair_wrench], [s.pair_force])
        self._launch(
            ledger.balance_energy, W,
            [M, s.ctl, s.clk, x.r1, x.v1, x.omega1, x.dx, x.psi, x.q1, s.qd, x.qd1, x.dq, s.lam0, s.lam,
             x.coordinate, s.stretch, s.drive_rate, s.applied, s.applied_at, s.load, s.load_on_modes,
             s.pair_force, s.modal_load, x.contact_energy, x.extra_energy],
            [s.energy],
        )  # fmt: skip
        self._launch(commit.decide, W, [M, s.energy, x.dx, s.pair_force], [s.ctl, s.clk])
        if P:
            self._block(commit.restore_contact, (W, P), [s.ctl, *before], [s.active, s.pressure, s.patch_offset])
        self._block(
            commit.keep_bodies, (W,),
            [s.ctl, x.r1, x.p1, x.v1, x.v1_rate, x.omega1, x.omega1_rate, x.dx, x.psi, s.clk],
            [s.r, s.p, s.v, s.v_rate, s.v_alg, s.omega, s.omega_rate, s.omega_alg],
        )  # fmt: skip
        if Q:
            self._block(
                commit.keep_modes, (W,), [M, s.ctl, s.clk, x.q1, x.qd1, x.qd1_rate, x.dq],
                [s.q, s.qd, s.qd_rate, s.qd_alg, s.modal_load],
            )  # fmt: skip
        self._launch(
            commit.keep_rest, W, [M, s.ctl, x.coordinate],
            [s.lam, s.lam0, s.stretch, s.drive_rate, s.applied, s.applied_at, s.load, s.load_on_modes, s.pair_force,
             s.energy],
        )  # fmt: skip
        self.record()
        self._launch(commit.count_attempts, 1, [s.ctl], [x.budget, x.more])

    def record(self) -> None:
        """Write the accepted state to the ring where RECORD is set."""
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        if m.pair_count:
            self._launch(
                record.sum_second,
                (W, m.pair_count),
                [M, s.ctl, x.station, x.station_wrench, x.second_load],
                [x.second_wrench],
            )
        self._launch(
            record.record, W,
            [M, s.clk, s.r, s.p, s.v, s.omega, s.v_rate, s.omega_rate, s.q, s.qd, s.qd_rate, s.lam, x.coordinate,
             x.row_wrench, x.center, x.station, s.active, x.pair_wrench,
             x.second_wrench, s.pressure, x.second_load, s.energy], [s.ctl, x.ring],
        )  # fmt: skip

    def evaluate(self, contact: bool = True) -> None:
        """Trial state of the increments, its unbalanced forces and rows, the diagonal of the tangent, and, with
        `contact`, the gaps and contact forces."""
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        Q, P, R = m.modal_count, m.pair_count, m.row_count
        self._block(
            motion.move_bodies, (W,),
            [M, s.ctl, s.clk, s.r, s.p, s.v, s.v_rate, s.v_alg, s.omega, s.omega_rate, s.omega_alg, x.dx, x.psi],
            [x.r1, x.p1, x.axes, x.v1, x.v1_rate, x.omega1, x.omega1_rate, x.residual, x.tangent, x.psi_inverse],
        )  # fmt: skip
        if Q:
            self._block(
                motion.move_modes, (W,), [M, s.ctl, s.clk, s.q, s.qd, s.qd_rate, s.qd_alg, s.modal_load, x.dq],
                [x.q1, x.qd1, x.qd1_rate, x.modal_residual, x.receptance],
            )  # fmt: skip
        if m.dense_count:
            self._add_inertia()
        if m.force_count:
            self._launch(
                rows.apply_forces, W, [M, s.ctl, s.clk, x.r1, x.axes, x.q1, x.slope],
                [x.residual, x.modal_residual, s.applied, s.applied_at],
            )  # fmt: skip
        if m.torque_count + m.load_count:
            self._launch(
                forces.apply_loads, W, [M, s.ctl, s.clk, x.axes, x.slope],
                [x.residual, x.modal_residual, s.load, s.load_on_modes],
            )  # fmt: skip
        if R:
            self._block(
                rows.evaluate_rows, (W,),
                [M, s.ctl, s.clk, x.r1, x.axes, x.v1, x.omega1, x.q1, x.qd1, s.lam, s.stretch, x.slope],
                [x.C, x.C_modal, x.coordinate, x.defect, x.softness, s.drive_rate, x.row_wrench, x.row_pull],
            )  # fmt: skip
            if m.group_count:
                self._block(
                    forces.couple_springs, (W,), [M, s.clk, s.lam, x.coordinate, s.drive_rate],
                    [s.ctl, x.flexibility, x.defect, x.softness],
                )  # fmt: skip
            if self.pattern is None:
                self._block(
                    outer.add_multipliers, (W,), [M, s.ctl, s.lam, x.C, x.C_modal], [x.residual, x.modal_residual]
                )
            else:
                self._block(
                    sparse_outer.pull, (W,), [M, self.patterns, s.ctl, s.lam, x.C, x.C_modal.flatten()],
                    [x.residual, x.modal_residual.flatten()],
                )  # fmt: skip
        if P and contact:
            self._locate_contact()

    def assemble(self) -> None:
        """The outer matrix and its right-hand side, after `evaluate`."""
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        if self.pattern is None:
            self._block(
                outer.condense, (W,),
                [M, s.ctl, x.C, x.C_modal, x.receptance, x.softness, x.flexibility, x.defect, x.residual,
                 x.modal_residual],
                [x.tangent, x.rhs, x.C_receptance],
            )  # fmt: skip
        else:
            self._block(
                sparse_outer.condense_sparse, (W,),
                [M, self.patterns, s.ctl, x.C, x.C_modal.flatten(), x.receptance.flatten(), x.softness, x.flexibility,
                 x.defect, x.residual, x.modal_residual.flatten()],
                [x.tangent, x.rhs],
            )  # fmt: skip
        if m.dense_count:
            self._block(
                inertia.couple_modes, (W,), [M, s.ctl, s.clk, x.omega1, x.omega1_rate, s.lam, x.row_pull],
                [x.tangent.flatten()],
            )  # fmt: skip
        if m.row_count:
            self._launch(stiffen.stiffen, W, [M, s.ctl, x.r1, x.axes, x.q1, x.slope, s.lam, x.row_wrench], [x.tangent])

    def _iteration(self) -> None:
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        Q, P, R = m.modal_count, m.pair_count, m.row_count
        self.evaluate()
        self._launch(
            outer.balance, W,
            [M, s.clk, x.r1, x.v1_rate, x.omega1, x.omega1_rate, x.dx, x.psi, s.lam, x.defect, x.softness,
             x.row_wrench, x.row_pull, s.load, s.load_on_modes, x.pair_wrench, x.gap_defect, x.modal_residual,
             s.modal_load, x.q1, x.qd1_rate, x.dq, x.residual],
            [s.ctl, x.residual_history],
        )  # fmt: skip
        self.assemble()
        if self.pattern is None:
            self._block(
                outer.factor_outer, (W,), [M, x.tangent, x.rhs],
                [s.ctl, x.scaling, x.pivots, x.elimination, x.inverse_transposed, x.z_free],
            )  # fmt: skip
        else:
            self._block(
                sparse_outer.solve_outer, (W,), [M, self.patterns, x.tangent, x.rhs.flatten()],
                [s.ctl, x.scaling, x.pivots, x.sparse_factor, x.sparse_vector, x.sparse_lines, x.fallback,
                 x.elimination, x.inverse_transposed, x.z_free],
            )  # fmt: skip
        z = x.z_free
        if P:
            z = x.z
            self._compliance()
            self._block(
                contact_solve.solve_pressures, (W,),
                [M, s.active, x.opened, x.base, x.slot_mode, x.condensed, x.J, x.L, x.V, x.receptance, x.modal_residual,
                 x.z_free],
                [s.ctl, x.right, x.order, x.factor, x.solution, s.pressure, x.z],
            )  # fmt: skip
        if Q:
            self._block(
                contact_solve.modal_increments, (W,),
                [M, s.ctl, s.active, x.slot_mode, x.J, s.pressure, x.base, x.C_modal, x.receptance, x.modal_residual,
                 z],
                [x.modal_step],
            )  # fmt: skip
        if P:
            self._correct()
        self._block(outer.advance_outer, (W,), [M, s.ctl, z, x.psi_inverse], [x.dx, x.psi])
        if R + Q:
            self._block(outer.advance_rest, (W,), [M, s.ctl, z, x.modal_step], [s.lam, x.dq])
        self._launch(outer.count_iteration, 1, [M], [s.ctl, x.running])

    def _add_inertia(self) -> None:
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        q, qd, qd_rate = x.q1.flatten(), x.qd1.flatten(), x.qd1_rate.flatten()
        self._block(inertia.sum_modes, (W,), [M, s.ctl, q, qd, qd_rate], [x.inertia_sums])
        self._block(
            inertia.add_inertia, (W,),
            [M, s.ctl, s.clk, x.omega1, x.omega1_rate, x.q1, x.qd1, x.qd1_rate, x.psi_inverse, x.inertia_sums],
            [x.residual, x.modal_residual, x.receptance, x.tangent, x.extra_energy],
        )  # fmt: skip
        if self.compiled.stiffened:
            self._block(inertia.shorten_interfaces, (W,), [M, s.ctl, q], [x.slope])

    def _project_velocities(self) -> None:
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        self._block(
            accuracy.missed_rates, (W,),
            [M, s.ctl, x.project, x.C, x.C_modal, x.v1, x.omega1, x.qd1, s.drive_rate], [x.missed],
        )  # fmt: skip
        self._block(
            accuracy.project_velocities, (W,),
            [M, s.ctl, x.project, x.missed, x.inverse_transposed, x.C_modal, x.receptance],
            [x.change, x.v1, x.omega1, x.qd1],
        )  # fmt: skip

    def _locate_contact(self) -> None:
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        P = m.pair_count
        self._launch(
            contact_geometry.locate, (W, P), [M, x.r1, x.axes], [s.ctl, x.phase, x.center, x.station, x.station_wrench]
        )
        self._launch(
            contact_geometry.open_window, (W, P), [M, s.ctl, x.phase, x.center],
            [s.active, s.pressure, s.patch_offset, x.window],
        )  # fmt: skip
        self._block(
            contact_geometry.sample, (W, P), [M, s.ctl, x.center, x.window, x.station], [x.point_gap, x.point_place]
        )
        self._block(
            contact_geometry.weigh, (W, P),
            [M, x.center, x.window, x.station, x.station_wrench, x.point_gap, x.point_place],
            [s.ctl, x.weak_gap, x.area, x.wrench, x.stencil, x.stencil_at],
        )  # fmt: skip
        self._block(
            contact_geometry.shift, (W, P),
            [M, s.ctl, x.center, x.window, x.station, x.station_wrench, x.area, x.weak_gap], [x.wrench, x.shifted_gap],
        )  # fmt: skip
        self._launch(
            contact_fields.set_second_window,
            (W, P),
            [M, s.ctl, x.window, x.area, x.stencil_at],
            [s.active, s.pressure, x.second_window],
        )
        self._block(
            contact_fields.modal_fields, (W, P),
            [M, s.ctl, x.center, x.window, x.second_window, x.q1.flatten(), 1], [x.first_field, x.second_field],
        )  # fmt: skip
        self._local_fields()
        self._block(
            contact_fields.close_gaps, (W, P),
            [M, s.ctl, x.window, x.shifted_gap, x.area, x.stencil, x.stencil_at, x.first_field, x.second_field,
             x.first_local, x.second_local, s.active, s.pressure], [x.gap, x.opened, x.base],
        )  # fmt: skip
        self._block(
            contact_fields.load_modes, (W,),
            [M, s.ctl, x.center, x.window, x.second_window, s.active, s.pressure, x.second_load.flatten()],
            [s.modal_load.flatten()],
        )  # fmt: skip
        self._launch(
            contact_fields.add_contact, W,
            [M, s.ctl, x.r1, x.axes, x.window, s.active, x.area, x.wrench, x.gap, x.opened, s.pressure, s.modal_load],
            [x.residual, x.modal_residual, x.pair_wrench, x.gap_defect, x.contact_energy],
        )  # fmt: skip

    def _local_fields(self) -> None:
        M, s, x = self.compiled.models, self.state, self.work
        self._block(
            contact_fields.local_fields, (self.worlds, self.compiled.model.pair_count),
            [M, s.ctl, x.center, x.window, x.second_window, s.active, x.stencil, x.stencil_at, s.pressure],
            [x.second_load.flatten(), x.first_local, x.second_local],
        )  # fmt: skip

    def _compliance(self) -> None:
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        self._launch(contact_compliance.take_slots, W, [M, s.active], [s.ctl, x.phase, x.slot_of, x.slot_mode])
        self._block(
            contact_compliance.respond, (W,),
            [M, s.ctl, x.center, x.second_window, x.slot_mode, x.stencil, x.stencil_at], [x.T],
        )  # fmt: skip
        self._block(
            contact_compliance.modal_rows, (W,), [M, s.ctl, x.center, x.slot_mode, x.stencil, x.stencil_at], [x.J]
        )
        self._block(
            contact_compliance.assemble, (W,),
            [M, s.ctl, x.center, x.slot_mode, x.stencil, x.stencil_at, x.T, x.J, x.receptance], [x.scaled_modes, x.G],
        )  # fmt: skip
        self._block(
            contact_compliance.outer_rows, (W,),
            [M, s.ctl, x.axes, x.r1, x.wrench, x.slot_mode, x.J, x.C_receptance, x.inverse_transposed], [x.L, x.V],
        )  # fmt: skip
        self._block(contact_compliance.condense_contact, (W,), [M, s.ctl, x.slot_mode, x.G, x.L, x.V], [x.condensed])

    def _correct(self) -> None:
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        P = m.pair_count
        self._block(
            contact_fields.modal_fields, (W, P),
            [M, s.ctl, x.center, x.window, x.second_window, x.modal_step, 0], [x.first_step, x.second_step],
        )  # fmt: skip
        self._local_fields()
        self._block(
            contact_solve.correct_set, (W, P),
            [M, s.ctl, x.axes, x.r1, x.window, x.area, x.wrench, x.stencil, x.stencil_at, x.gap, x.first_step,
             x.second_step, x.first_local, x.second_local, x.z, s.pressure, s.active], [x.proposed],
        )  # fmt: skip
        self._launch(
            contact_solve.accept_set, W, [M, x.center, x.proposed], [s.ctl, s.active, s.pressure, x.window]
        )  # fmt: skip
