"""The part of the step graph that belongs to layers whose yield is no constant; `ContactGraph` calls the parts in the
places named, in scenes that have such a layer."""

from __future__ import annotations

from warpffrf_kernels import contact_layer, layer_energy

from warpffrf.online.launcher import Launcher

MODULES = (contact_layer, layer_energy)


class LayerGraph(Launcher):
    """Records the kernels of `warpffrf_kernels.contact_layer` and `layer_energy`."""

    def linearise(self) -> None:
        """The tangent of the laws at the present pressures, and the weak yield and flexibility that it gives; after the
        windows are laid, before the first `add_yield`."""
        M, s, x, W, P = self.compiled.models, self.state, self.work, self.worlds, self.compiled.model.pair_count
        self.block(
            contact_layer.linearise_layer, (W, P),
            [M, s.ctl, s.clk, x.center, x.window, s.active, s.pressure, s.layer_depth, s.layer_drag,
             s.layer_column],
            [x.layer_support, x.layer_past, x.layer_past_drag, x.layer_at, x.layer_flexibility, x.layer_beginning],
        )  # fmt: skip
        self.block(
            contact_layer.weigh_layer, (W, P), [M, s.ctl, x.center, x.window, x.layer_flexibility, x.layer_beginning],
            [x.layer_offset, x.layer_tangent],
        )  # fmt: skip

    def add_yield(self) -> None:
        """What the layers open, added to what the local modes do; after `contact_fields.local_fields`."""
        s, x = self.state, self.work
        self.block(
            contact_layer.add_yield, (self.worlds, self.compiled.model.pair_count),
            [self.compiled.models, s.ctl, x.window, s.active, s.pressure, x.layer_offset, x.layer_tangent],
            [x.first_local],
        )  # fmt: skip

    def add_flexibility(self) -> None:
        """The layers' compliance, added to the matrix of the local solve; after `condense_contact`."""
        s, x = self.state, self.work
        self.block(
            contact_layer.add_flexibility, (self.worlds,),
            [self.compiled.models, s.ctl, s.active, x.area, x.slot_of, x.slot_mode, x.layer_tangent],
            [x.layer_support, x.condensed],
        )  # fmt: skip

    def measure(self) -> None:
        """After `balance`: the energy of the layers where the iteration has converged, and what damped ones lose."""
        s, x = self.state, self.work
        self.launch(
            layer_energy.add_layer_energy, self.worlds,
            [self.compiled.models, s.ctl, s.clk, x.center, x.window, s.active, s.pressure, x.area, x.opened,
             x.layer_offset, x.layer_tangent, x.layer_past, x.layer_past_drag, s.impulsive, x.theta],
            [x.layer_now, x.layer_drag_now, x.pair_loss, s.pair_energy],
        )  # fmt: skip

    def keep(self) -> None:
        """Depths of damped layers after an accepted step."""
        s, x = self.state, self.work
        self.block(
            layer_energy.keep_layer, (self.worlds, self.compiled.model.pair_count),
            [self.compiled.models, s.ctl, x.center, x.layer_now, x.layer_drag_now],
            [s.layer_depth, s.layer_drag, s.layer_column],
        )  # fmt: skip
