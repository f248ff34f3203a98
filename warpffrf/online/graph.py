"""The step as a graph: recorded once, replayed until a chunk of steps is done.

One attempt of a step is: begin, predict, the Newton loop (evaluate, is it balanced? condense, contact, advance),
velocities projected and the local error estimated where asked for, ledger, decision, copy, record. What a scene does
not have (contact, modes, inertia terms, rows, loads) records no kernel. Nothing here runs on the host while a graph
replays.
"""

from __future__ import annotations

from typing import Any

import warp as wp
from warpffrf_kernels import (
    accuracy,
    balance,
    commit,
    contact_solve,
    energy_watch,
    forces,
    impulsive_contact,
    inertia,
    interfaces,
    keep_contact,
    ledger,
    motion,
    outer,
    record,
    rows,
    sparse_outer,
    stiffen,
)
from warpffrf_kernels import control as k
from warpffrf_kernels.scalars import BLOCK

from warpffrf.online import contact_graph, friction_graph, layer_graph
from warpffrf.online.compile import CompiledScene
from warpffrf.online.launcher import Launcher
from warpffrf.online.outer_pattern import on_device, pattern_of
from warpffrf.online.state import State, Work

OWN_MODULES = (
    accuracy, balance, commit, energy_watch, forces, inertia, interfaces, keep_contact, ledger, motion, outer, record,
    rows, sparse_outer, stiffen,
)  # fmt: skip


STARTING = ("v_rate", "v_alg", "omega_rate", "omega_alg", "qd_rate", "qd_alg")


class StepGraph(Launcher):
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
        super().__init__(compiled, state, work, worlds)
        self.contact = contact_graph.ContactGraph(compiled, state, work, worlds)
        # what an attempt starts from: without contact the accelerations as they are
        self.v_rate0, self.v_alg0, self.omega_rate0, self.omega_alg0, self.qd_rate0, self.qd_alg0 = (
            getattr(work, name + "0") if compiled.model.pair_count else getattr(state, name) for name in STARTING
        )
        self.projected, self.adaptive = projected and compiled.model.row_count > 0, adaptive
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
        self.launch(commit.count_attempts, 1, [self.state.ctl], [self.work.budget, self.work.more])
        wp.capture_launch(self.graph)
        if wp.get_device(self.device).is_cuda:
            wp.synchronize_device(self.device)

    # --- recording

    def _load_modules(self) -> None:
        """Compile before the capture: modules cannot be loaded inside one."""
        friction = friction_graph.MODULES if self.contact.friction else ()
        layer = layer_graph.MODULES if self.contact.layer else ()
        for module in (*OWN_MODULES, *contact_graph.MODULES, *friction, *layer):
            wp.load_module(module, device=self.device, block_dim=BLOCK)
            wp.load_module(module, device=self.device)

    def _attempt(self) -> None:
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        Q, P = m.modal_count, m.pair_count
        self.launch(motion.begin_step, W, [M, x.coefficients, x.local_coefficients], [s.ctl, s.clk])
        if P:
            self.contact.begin()
        self.block(
            motion.predict_bodies, (W,),
            [s.ctl, s.clk, s.v, self.v_rate0, self.v_alg0, s.omega, self.omega_rate0, self.omega_alg0], [x.dx, x.psi],
        )  # fmt: skip
        if Q:
            self.block(
                motion.predict_modes, (W,), [M, s.ctl, s.clk, s.q, s.qd, self.qd_rate0, self.qd_alg0, s.modal_load],
                [x.dq, x.exact],
            )  # fmt: skip
        if P:
            before = [x.active_before, x.pressure_before, x.offset_before]
            self.block(keep_contact.remember_contact, (W, P), [s.ctl, s.active, s.pressure, s.patch_offset], before)
        friction, layer = self.contact.friction, self.contact.layer
        if friction:
            friction.remember()
        x.running.fill_(1)
        wp.capture_while(x.running, self.iterate)
        if P:
            self.contact.finish()
        if self.projected:
            self._project_velocities()
        if self.adaptive:
            self.launch(
                accuracy.estimate_error, W,
                [M, s.ctl, x.accuracy, s.v_rate, x.v1_rate, s.omega_rate, x.omega1_rate, s.qd_rate, x.qd1_rate],
                [s.clk],
            )  # fmt: skip
        self._balance_energy()
        if P:
            self.contact.judge()
        self.launch(
            commit.decide, W, [M, s.energy, x.dx, s.pair_force, x.restless, x.wanted, x.created_now],
            [s.impulsive, s.ctl, s.clk],
        )  # fmt: skip
        if P:
            self.contact.keep()
            self.block(keep_contact.restore_contact, (W, P), [s.ctl, *before], [s.active, s.pressure, s.patch_offset])
        if friction:
            friction.keep()
        if layer:
            layer.keep()
        self.block(
            commit.keep_bodies, (W,),
            [M, s.ctl, x.r1, x.p1, x.v1, x.v1_rate, x.omega1, x.omega1_rate, x.dx, x.psi, s.clk, self.v_alg0,
             self.omega_alg0, x.v_rest, x.omega_rest],
            [s.r, s.p, s.v, s.v_rate, s.v_alg, s.omega, s.omega_rate, s.omega_alg],
        )  # fmt: skip
        if Q:
            self.block(
                commit.keep_modes, (W,), [M, s.ctl, s.clk, x.q1, x.qd1, x.qd1_rate, x.dq, self.qd_alg0, x.qd_rest],
                [s.q, s.qd, s.qd_rate, s.qd_alg, s.modal_load],
            )  # fmt: skip
        if self.projected:
            self.block(
                accuracy.correct_algorithmic, (W,), [M, s.ctl, x.project, s.clk, x.change, x.modal_step],
                [s.v_alg, s.omega_alg, s.qd_alg],
            )  # fmt: skip
        self.launch(
            commit.keep_rest, W, [M, x.coordinate],
            [s.ctl, s.lam, s.lam0, s.stretch, s.drive_rate, s.applied, s.applied_at, s.load, s.load_on_modes,
             s.energy],
        )  # fmt: skip
        self.launch(energy_watch.watch_energy, W, [M, s.energy, s.pair_energy, s.created], [s.made, s.ctl, s.clk])
        self.record()
        self.launch(commit.count_attempts, 1, [s.ctl], [x.budget, x.more])

    def record(self) -> None:
        """Write the accepted state to the ring where RECORD is set."""
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        if m.pair_count:
            self.launch(
                record.sum_second, (W, m.pair_count), [M, s.ctl, x.r1, x.axes, x.second_load], [x.second_wrench]
            )
            self.contact.record()
        if self.contact.friction:
            self.contact.friction.record()
        self.launch(
            record.record, W,
            [M, s.clk, s.r, s.p, s.v, s.omega, s.v_rate, s.omega_rate, s.q, s.qd, s.qd_rate, s.lam, x.coordinate,
             x.row_wrench, x.center, x.station, s.active, x.pair_wrench,
             x.second_wrench, s.pressure, x.second_load, s.energy], [s.ctl, x.ring],
        )  # fmt: skip

    def _balance_energy(self) -> None:
        M, s, x = self.compiled.models, self.state, self.work
        self.launch(
            ledger.balance_energy, self.worlds,
            [M, s.ctl, x.r1, x.v1, x.omega1, x.dx, x.psi, x.q1, x.qd1, x.dq, s.lam0, s.lam,
             x.coordinate, s.stretch, s.applied, s.applied_at, s.load, s.load_on_modes,
             s.impulsive, x.theta, s.pair_force, s.pair_modal, s.friction_force, s.friction_modal, s.pair_energy,
             s.elastic_energy, x.pair_loss, x.extra_energy, x.friction_work],
            [s.clk, s.energy],
        )  # fmt: skip

    def open_books(self) -> None:
        """The energies of the state that was evaluated last, in every world, as the first of the ledger."""
        words = self.state.ctl.numpy().copy()
        words[:, int(k.ATTEMPT)] = 1
        self.state.ctl.assign(words)
        self._balance_energy()
        words[:, int(k.ATTEMPT)] = 0
        self.state.ctl.assign(words)
        lines = self.state.energy.numpy().copy()
        lines[:, 0] = lines[:, 1]
        self.state.energy.assign(lines)

    def stand_still(self) -> None:
        """Before an `evaluate` that is no part of an attempt: accelerations as they are, no pair impulsive."""
        s, x = self.state, self.work
        if self.compiled.model.pair_count:
            for name in STARTING:
                wp.copy(getattr(x, name + "0"), getattr(s, name))
            s.impulsive.zero_()
            x.weight.fill_(1.0)

    def evaluate(self, contact: bool = True) -> None:
        """Trial state of the increments, its unbalanced forces and rows, the diagonal of the tangent, and, with
        `contact`, the gaps and contact forces."""
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        Q, P, R = m.modal_count, m.pair_count, m.row_count
        self.block(
            motion.move_bodies, (W,),
            [M, s.ctl, s.clk, s.r, s.p, s.v, self.v_rate0, self.v_alg0, s.omega, self.omega_rate0, self.omega_alg0,
             x.dx, x.psi],
            [x.r1, x.p1, x.axes, x.v1, x.v1_rate, x.omega1, x.omega1_rate, x.residual, x.tangent, x.psi_inverse],
        )  # fmt: skip
        if P:
            self.launch(motion.hold_motions, W, [M, s.ctl, x.dx, x.psi, x.hold, x.hold_count], [x.residual])
        if Q:
            self.block(
                motion.move_modes, (W,),
                [M, s.ctl, s.clk, s.q, s.qd, self.qd_rate0, self.qd_alg0, s.modal_load, x.exact, x.dq],
                [x.q1, x.qd1, x.qd1_rate, x.modal_residual, x.receptance],
            )  # fmt: skip
        if m.dense_count:
            self._add_inertia()
        if m.interface_count:
            self.block(interfaces.move_interfaces, (W,), [M, s.ctl, x.q1.flatten(), x.slope], [x.interface_motion])
        if m.force_count:
            self.launch(
                rows.apply_forces, W, [M, s.ctl, s.clk, x.r1, x.axes, x.slope, x.interface_motion],
                [x.residual, x.modal_residual.flatten(), s.applied, s.applied_at],
            )  # fmt: skip
        if m.torque_count + m.load_count:
            self.launch(
                forces.apply_loads, W, [M, s.ctl, s.clk, x.axes, x.slope],
                [x.residual, x.modal_residual.flatten(), s.load, s.load_on_modes.flatten(), x.applied_torque],
            )  # fmt: skip
        if R:
            self.block(
                rows.evaluate_rows, (W,),
                [M, s.ctl, s.clk, x.r1, x.axes, x.v1, x.omega1, x.qd1.flatten(), s.lam, s.stretch, x.slope,
                 x.interface_motion],
                [x.C, x.C_modal.flatten(), x.coordinate, x.defect, x.softness, s.drive_rate, x.row_wrench, x.row_pull],
            )  # fmt: skip
            if m.group_count:
                self.block(
                    forces.couple_springs, (W,), [M, s.clk, s.lam, x.coordinate, s.drive_rate],
                    [s.ctl, x.flexibility, x.defect, x.softness],
                )  # fmt: skip
            if self.pattern is None:
                self.block(
                    outer.add_multipliers, (W,), [M, s.ctl, s.lam, x.C, x.C_modal.flatten()],
                    [x.residual, x.modal_residual.flatten()],
                )  # fmt: skip
            else:
                self.block(
                    sparse_outer.pull, (W,), [M, self.patterns, s.ctl, s.lam, x.C, x.C_modal.flatten()],
                    [x.residual, x.modal_residual.flatten()],
                )  # fmt: skip
        if P and contact:
            self.contact.locate()

    def assemble(self) -> None:
        """The outer matrix and its right-hand side, after `evaluate`."""
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        if self.pattern is None:
            self.block(
                outer.condense, (W,),
                [M, s.ctl, x.C, x.C_modal.flatten(), x.receptance.flatten(), x.softness, x.flexibility, x.defect,
                 x.residual, x.modal_residual.flatten()],
                [x.tangent, x.rhs, x.C_receptance],
            )  # fmt: skip
        else:
            self.block(
                sparse_outer.condense_sparse, (W,),
                [M, self.patterns, s.ctl, x.C, x.C_modal.flatten(), x.receptance.flatten(), x.softness, x.flexibility,
                 x.defect, x.residual, x.modal_residual.flatten()],
                [x.tangent, x.rhs],
            )  # fmt: skip
        if m.dense_count:
            self.block(
                inertia.couple_modes, (W,), [M, s.ctl, s.clk, x.omega1, x.omega1_rate, s.lam, x.row_pull],
                [x.tangent.flatten()],
            )  # fmt: skip
        if m.row_count:
            self.launch(
                stiffen.stiffen, W, [M, s.ctl, x.r1, x.axes, x.slope, x.interface_motion, s.lam, x.row_wrench],
                [x.tangent],
            )  # fmt: skip
        if m.pair_count:
            self.block(motion.add_held, (W,), [M, s.ctl, x.hold, x.hold_count], [x.tangent])
        if m.force_count + m.torque_count:
            self.launch(
                stiffen.stiffen_applied, W,
                [M, s.ctl, x.axes, x.slope, x.interface_motion, s.applied, x.applied_torque], [x.tangent],
            )  # fmt: skip

    def iterate(self) -> None:
        """One Newton iteration: the linearised step, and the increments with it where the active set has settled."""
        m, M, s, x, W = self.compiled.model, self.compiled.models, self.state, self.work, self.worlds
        Q, P, R = m.modal_count, m.pair_count, m.row_count
        self.evaluate()
        self.launch(
            balance.balance, W,
            [M, s.clk, x.r1, x.v1_rate, x.omega1, x.omega1_rate, x.dx, x.psi, s.lam, x.defect, x.softness,
             x.row_wrench, x.row_pull, s.load, s.load_on_modes, x.pair_wrench, x.gap_defect, x.modal_residual,
             s.modal_load, s.pair_modal, x.q1, x.qd1_rate, x.dq, x.residual],
            [s.ctl, x.residual_history],
        )  # fmt: skip
        if P:
            self.contact.balance_means()
        self.assemble()
        if self.pattern is None:
            self.block(
                outer.factor_outer, (W,), [M, x.tangent, x.rhs.flatten()],
                [s.ctl, x.scaling, x.pivots, x.elimination, x.inverse_transposed, x.z_free],
            )  # fmt: skip
        else:
            self.block(
                sparse_outer.solve_outer, (W,), [M, self.patterns, x.tangent, x.rhs.flatten()],
                [s.ctl, x.scaling, x.pivots, x.sparse_factor, x.sparse_vector, x.sparse_lines, x.fallback,
                 x.elimination, x.inverse_transposed, x.z_free],
            )  # fmt: skip
        z = x.z_free
        if P:
            z = x.z
            self.contact.solve()
        if Q:
            self._increase_modes(z)
        if P:
            self.contact.correct()
        if self.contact.friction:
            self.contact.friction.solve()
            if Q:
                self._increase_modes(z)
                self.contact.friction.push_modes()
        self.block(outer.advance_outer, (W,), [M, s.ctl, z, x.psi_inverse], [x.dx, x.psi])
        if R + Q:
            self.block(outer.advance_rest, (W,), [M, s.ctl, z, x.modal_step], [s.lam, x.dq])
        self.launch(outer.count_iteration, 1, [M], [s.ctl, x.running])

    def _increase_modes(self, z: Any) -> None:
        """Increments of the modes with the outer ones z and the pressures."""
        M, s, x = self.compiled.models, self.state, self.work
        self.block(
            contact_solve.modal_increments, (self.worlds,),
            [M, s.ctl, s.active, x.slot_mode, x.weight, x.J, s.pressure, x.base, x.C_modal.flatten(), x.receptance,
             x.modal_residual, z],
            [x.modal_step],
        )  # fmt: skip
        if self.contact.local_inertia:
            self.block(
                impulsive_contact.push_further, (self.worlds,),
                [M, s.ctl, s.active, x.slot_mode, x.J, s.pressure, x.base, x.weight, x.receptance,
                 x.contact_receptance],
                [x.modal_push, x.modal_step],
            )  # fmt: skip

    def _add_inertia(self) -> None:
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        q, qd, qd_rate = x.q1.flatten(), x.qd1.flatten(), x.qd1_rate.flatten()
        self.block(inertia.sum_modes, (W,), [M, s.ctl, q, qd, qd_rate], [x.inertia_sums])
        self.block(
            inertia.add_inertia, (W,),
            [M, s.ctl, s.clk, x.omega1, x.omega1_rate, x.q1, x.qd1, x.qd1_rate, x.psi_inverse, x.inertia_sums],
            [x.residual, x.modal_residual, x.receptance, x.tangent, x.extra_energy],
        )  # fmt: skip
        if self.compiled.stiffened:
            self.block(inertia.shorten_interfaces, (W,), [M, s.ctl, q], [x.slope])

    def _project_velocities(self) -> None:
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        self.block(
            accuracy.missed_rates, (W,),
            [M, s.ctl, x.project, x.C, x.C_modal, x.v1, x.omega1, x.qd1, s.drive_rate], [x.missed],
        )  # fmt: skip
        self.block(
            accuracy.project_velocities, (W,),
            [M, s.ctl, x.project, x.missed.flatten(), x.inverse_transposed, x.C_modal, x.receptance, s.clk],
            [x.change, x.modal_step, x.v1, x.omega1, x.qd1, x.v1_rate, x.omega1_rate, x.qd1_rate, s.lam],
        )  # fmt: skip
