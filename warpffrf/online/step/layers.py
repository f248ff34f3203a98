"""Layers with nonlinear or damped laws (`warpffrf_kernels.layers.weak_layer`, `layer_energy`)."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.layers import layer_energy, weak_layer

LAYERS = Participant(
    "layers",
    when="layer_point",
    cells=[blocks(weak_layer.linearise_layer, "pair"), blocks(weak_layer.weigh_layer, "pair")],
    displace=[blocks(weak_layer.add_yield, "pair")],
    store=[threads(layer_energy.add_layer_energy)],
    condense=[blocks(weak_layer.find_support), blocks(weak_layer.add_flexibility)],
    keep=[blocks(layer_energy.keep_layer, "pair")],
)
