"""The contact part of the step graph: gaps and forces of the trial state, the local solve, and the active set."""

from __future__ import annotations

from typing import Any

from warpffrf_kernels import (
    contact_assembly,
    contact_compliance,
    contact_few,
    contact_fields,
    contact_geometry,
    contact_place,
    contact_points,
    contact_solve,
    contact_weights,
    contact_window,
    contact_wrench,
    impulsive_contact,
    impulsive_means,
    impulsive_memory,
    shared_assembly,
    shared_surface,
)

from warpffrf.online.compile_friction import has_friction
from warpffrf.online.compile_shared import serves_several
from warpffrf.online.friction_graph import FrictionGraph
from warpffrf.online.launcher import Launcher
from warpffrf.online.layer_graph import LayerGraph

MODULES = (
    contact_geometry, contact_weights, contact_window, contact_few, contact_place, contact_points, contact_wrench,
    contact_compliance, contact_assembly, contact_fields, contact_solve, impulsive_contact, impulsive_means,
    impulsive_memory, shared_surface, shared_assembly,
)  # fmt: skip


class ContactGraph(Launcher):
    """Records the kernels of all contact pairs: of the two families of geometry those that the scene has, and
    `friction` those of the pairs that have any."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        m = self.compiled.model
        families, counts = m.pair_family.numpy()[: m.pair_count], m.pair_point_count.numpy()[: m.pair_count]
        self.families = set(families.tolist())
        self.few = bool(((families == 0) & (counts > 0)).any())
        self.friction = FrictionGraph(*arguments) if has_friction(self.compiled.scene) else None
        self.layer = LayerGraph(*arguments) if m.layer_count else None
        self.shared = serves_several(m)
        self.local_inertia = m.dynamic_count > 0

    def locate(self) -> None:
        """Windows, gaps and contact forces of the trial state."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        if 0 in self.families:
            self.launch(
                contact_geometry.locate, (W, P), [M, x.r1, x.axes],
                [s.ctl, x.phase, x.center, x.station, x.station_wrench],
            )  # fmt: skip
        if 1 in self.families:
            self.launch(
                contact_place.locate_points, (W, P), [M, x.r1, x.axes],
                [s.ctl, x.phase, x.center, x.nearest, x.touched],
            )  # fmt: skip
        self.launch(
            contact_window.open_window, (W, P), [M, s.ctl, x.phase, x.nearest, x.touched],
            [x.center, x.station, s.active, s.pressure, s.patch_offset, x.window],
        )  # fmt: skip
        weak = [x.weak_gap, x.area, x.wrench, x.stencil, x.stencil_at]
        if 0 in self.families:
            self.block(
                contact_geometry.sample, (W, P), [M, s.ctl, x.center, x.window, x.station], [x.point_gap, x.point_place]
            )
            self.block(
                contact_weights.weigh, (W, P),
                [M, x.center, x.window, x.station, x.station_wrench, x.point_gap, x.point_place], [s.ctl, *weak],
            )  # fmt: skip
        if 1 in self.families:
            self.block(
                contact_wrench.hold_contact_frame, (W, P), [M, s.ctl, x.r1, x.axes, x.nearest], [x.held, x.held_ball]
            )
            self.block(
                contact_points.sample_points, (W, P),
                [M, s.ctl, x.r1, x.axes, x.center, x.window, x.held, x.held_ball], [x.point_line],
            )  # fmt: skip
            self.block(
                contact_points.weigh_points, (W, P), [M, x.axes, x.center, x.window, x.point_line],
                [s.ctl, x.weak_gap, x.area, x.wrench, x.more_wrench, x.stencil, x.stencil_at],
            )  # fmt: skip
        if self.few:
            self._look_at_few(weak)
        self.block(
            contact_weights.shift, (W, P),
            [M, s.ctl, x.center, x.window, x.station, x.station_wrench, x.area, x.weak_gap], [x.wrench, x.shifted_gap],
        )  # fmt: skip
        self.launch(
            contact_fields.set_second_window,
            (W, P),
            [M, s.ctl, x.window, x.area, x.stencil_at],
            [s.active, s.pressure, x.second_window],
        )
        self.block(
            contact_fields.modal_fields, (W, P),
            [M, s.ctl, x.center, x.window, x.second_window, x.q1.flatten(), 1], [x.first_field, x.second_field],
        )  # fmt: skip
        if self.friction:
            self.friction.place()
        if self.layer:
            self.layer.linearise()
        self._local_fields()
        self.block(
            contact_fields.close_gaps, (W, P),
            [M, s.ctl, x.window, x.shifted_gap, x.area, x.stencil, x.stencil_at, x.first_field, x.second_field,
             x.first_local, x.second_local, s.active, s.pressure], [x.gap, x.opened, x.base],
        )  # fmt: skip
        self.block(
            contact_fields.load_modes, (W, P),
            [M, s.ctl, x.center, x.window, x.second_window, s.active, s.pressure, x.second_load.flatten()],
            [s.pair_modal.flatten()],
        )  # fmt: skip
        if self.friction:
            self.friction.slide()
        self.launch(
            contact_fields.sum_contact, W,
            [M, s.ctl, x.window, s.active, x.area, x.wrench, x.gap, x.opened, x.more_wrench, s.pressure],
            [x.pair_wrench, x.gap_defect, s.pair_energy],
        )  # fmt: skip
        if self.friction:
            self.friction.add()
        self.block(
            impulsive_contact.push_bodies, (W,),
            [M, s.ctl, s.clk, x.r1, x.axes, x.pair_wrench, x.normal_wrench, s.impulsive, x.theta, s.pair_modal,
             s.friction_modal],
            [s.pair_force, s.friction_force, s.modal_load, x.residual, x.modal_residual],
        )  # fmt: skip

    def begin(self) -> None:
        """Which pairs the attempt takes as impulsive, and the accelerations of its beginning without them."""
        M, s, x = self.compiled.models, self.state, self.work
        self.block(
            impulsive_contact.begin_contact, (self.worlds,),
            [M, s.clk, s.v_rate, s.v_alg, s.omega_rate, s.omega_alg, s.qd_rate, s.qd_alg, *self._forces(),
             *self._memory()],
            [s.ctl, s.impulsive, x.theta, x.bracket, x.weight, x.v_rate0, x.v_alg0, x.omega_rate0, x.omega_alg0,
             x.qd_rate0, x.qd_alg0],
        )  # fmt: skip

    def balance_means(self) -> None:
        """After `balance`: mean forces of impulsive pairs that give back their energy, where it has converged."""
        M, s, x = self.compiled.models, self.state, self.work
        if self.layer:
            self.layer.measure()
        self.launch(
            impulsive_means.balance_means, self.worlds,
            [M, s.clk, s.v, s.omega, s.qd, x.dx, x.psi, x.dq, *self._forces(), s.pair_energy, x.pair_loss,
             s.impulsive],
            [s.ctl, x.theta, x.bracket, x.weight, x.residual, x.modal_residual],
        )  # fmt: skip

    def finish(self) -> None:
        """After the Newton loop: impulsive pairs in the velocities and accelerations."""
        M, s, x = self.compiled.models, self.state, self.work
        self.block(
            impulsive_memory.finish_rates, (self.worlds,),
            [M, s.ctl, s.clk, s.impulsive, x.theta, *self._forces(), *self._memory()],
            [x.v1, x.v1_rate, x.omega1, x.omega1_rate, x.qd1, x.qd1_rate, x.v_rest, x.omega_rest, x.qd_rest],
        )  # fmt: skip

    def judge(self) -> None:
        """What the pairs make of the energy in the attempt, and which are to be impulsive in another one."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.launch(
            impulsive_means.judge_pairs, (W, P),
            [M, s.ctl, s.clk, s.impulsive, x.theta, s.pair_force, s.pair_modal, s.memory, s.modal_memory,
             s.pair_energy, x.pair_loss, x.dx, x.psi, x.dq, s.v, s.omega, s.qd],
            [x.wanted, x.created_now],
        )  # fmt: skip
        if self.local_inertia:
            self.launch(
                impulsive_means.find_restless, (W, P),
                [M, s.ctl, x.area, s.pressure, x.pressure_before, s.patch_offset, x.offset_before], [x.restless],
            )  # fmt: skip

    def keep(self) -> None:
        """After the decision: forces and energies of the pairs, and what the integrator remembers of them."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.block(
            impulsive_memory.keep_memory, (W, P), [M, s.ctl, s.clk, s.impulsive, x.created_now],
            [*self._forces(), s.pair_energy, s.elastic_energy, *self._memory(), s.created],
        )  # fmt: skip

    def _forces(self) -> list[Any]:
        s = self.state
        return [s.pair_force, s.pair_modal, s.friction_force, s.friction_modal]

    def _memory(self) -> list[Any]:
        s = self.state
        return [s.memory, s.modal_memory, s.friction_memory, s.modal_friction_memory]

    def _look_at_few(self, weak: list[Any]) -> None:
        """Weak gaps of the pairs on the line of centres that have a list of points."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.block(
            contact_few.sample_few, (W, P), [M, s.ctl, x.center, x.window, x.station], [x.point_gap, x.point_place]
        )
        self.block(
            contact_few.weigh_few, (W, P),
            [M, x.center, x.window, x.station, x.station_wrench, x.point_gap, x.point_place], [s.ctl, *weak],
        )  # fmt: skip
        self.block(
            contact_few.shift_few, (W, P),
            [M, s.ctl, x.center, x.window, x.station, x.station_wrench, x.area, x.weak_gap], [x.wrench, x.shifted_gap],
        )  # fmt: skip

    def record(self) -> None:
        """What is recorded of pairs whose gaps are taken at points, beside what all pairs have."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        if 1 not in self.families:
            return
        self.launch(
            contact_points.sum_points_second, (W, P),
            [M, s.ctl, x.axes, x.window, s.active, s.pressure, x.point_line], [x.second_wrench],
        )  # fmt: skip
        self.launch(contact_place.measure_approach, (W, P), [M, s.ctl, x.r1, x.axes, x.nearest], [x.station])

    def solve(self) -> None:
        """Pressures of the active set, and the outer increments z with them."""
        self._assemble()
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        self.block(
            contact_solve.solve_pressures, (W,),
            [M, s.active, x.opened, x.base, x.slot_mode, x.condensed, x.weight, x.J, x.L, x.V,
             x.receptance.flatten(), x.modal_residual.flatten(), x.z_free],
            [s.ctl, x.right, x.order, x.factor, x.solution, s.pressure, x.z],
        )  # fmt: skip

    def correct(self) -> None:
        """The active set after a solve, and the gaps that decide it."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.block(
            contact_fields.modal_fields, (W, P),
            [M, s.ctl, x.center, x.window, x.second_window, x.modal_step, 0], [x.first_step, x.second_step],
        )  # fmt: skip
        self._local_fields()
        self.block(
            contact_solve.correct_set, (W, P),
            [M, s.ctl, x.axes, x.r1, x.window, x.area, x.wrench, x.stencil, x.stencil_at, x.gap, x.first_step,
             x.second_step, x.first_local, x.second_local, x.z, s.pressure, s.active], [x.proposed],
        )  # fmt: skip
        self.launch(contact_solve.accept_set, W, [M, x.center, x.proposed], [s.ctl, s.active, s.pressure, x.window])

    def _assemble(self) -> None:
        """G of the active hats, and what contact sees of it with the outer coordinates condensed."""
        M, s, x, W = self.compiled.models, self.state, self.work, self.worlds
        receptance = x.receptance
        if self.local_inertia:
            receptance = x.contact_receptance
            self.block(
                impulsive_contact.compare_receptances, (W,), [M, s.ctl, s.clk, x.receptance], [x.contact_receptance]
            )
        self.launch(contact_compliance.take_slots, W, [M, s.active], [s.ctl, x.phase, x.slot_of, x.slot_mode])
        self.block(
            contact_compliance.respond, (W,),
            [M, s.ctl, x.center, x.second_window, x.slot_mode, x.stencil, x.stencil_at], [x.T],
        )  # fmt: skip
        self.block(
            contact_compliance.modal_rows, (W,), [M, s.ctl, x.center, x.slot_mode, x.stencil, x.stencil_at, x.weight],
            [x.J],
        )  # fmt: skip
        self.block(
            contact_assembly.assemble, (W,),
            [M, s.ctl, x.center, x.slot_mode, x.stencil, x.stencil_at, x.T, x.J, receptance], [x.scaled_modes, x.G],
        )  # fmt: skip
        if self.shared:
            self.block(
                shared_assembly.assemble_shared, (W,),
                [M, s.ctl, x.center, x.second_window, x.slot_mode, x.stencil, x.stencil_at, x.weight],
                [x.shared_field, x.G],
            )  # fmt: skip
        self.block(
            contact_compliance.outer_rows, (W,),
            [M, s.ctl, x.axes, x.r1, x.wrench, x.weight, x.slot_mode, x.J, x.C_receptance, x.inverse_transposed],
            [x.L, x.V],
        )  # fmt: skip
        self.block(contact_compliance.condense_contact, (W,), [M, s.ctl, x.slot_mode, x.G, x.L, x.V], [x.condensed])
        if self.layer:
            self.layer.add_flexibility()

    def _local_fields(self) -> None:
        M, s, x = self.compiled.models, self.state, self.work
        self.block(
            contact_fields.local_fields, (self.worlds, self.compiled.model.pair_count),
            [M, s.ctl, x.center, x.window, x.second_window, s.active, x.stencil, x.stencil_at, s.pressure],
            [x.second_load.flatten(), x.first_local, x.second_local],
        )  # fmt: skip
        if self.shared:
            self.block(
                shared_surface.share_pressures, (self.worlds, self.compiled.model.pair_count),
                [M, s.ctl, x.center, x.window, x.second_window, s.active, s.pressure, x.second_load.flatten()],
                [x.first_local, x.second_local],
            )  # fmt: skip
        if self.friction:
            self.friction.add_push()
        if self.layer:
            self.layer.add_yield()
