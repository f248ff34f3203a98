"""Layers whose yield is no constant (`warpffrf_kernels.layers.weak_layer`, `layer_energy`)."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.outer import FACTOR
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.layers import layer_energy, weak_layer

BEFORE = {"depth_before": "layer_depth", "drag_before": "layer_drag", "column_before": "layer_column"}
NOW = {"depth_now": "layer_now", "drag_now": "layer_drag_now"}
PAST = {"past": "layer_past", "past_drag": "layer_past_drag"}
LAW = {"flexibility": "layer_flexibility", "beginning": "layer_beginning"}
WEAK = {"offset": "layer_offset", "tangent": "layer_tangent"}
SUPPORT = {"support": "layer_support"}

LAYERS = Participant(
    "layers",
    when="layer_point",
    cells=[
        blocks(weak_layer.linearise_layer, "pair", depth="layer_at", **BEFORE, **PAST, **LAW, **SUPPORT),
        blocks(weak_layer.weigh_layer, "pair", **LAW, **WEAK),
    ],
    displace=[blocks(weak_layer.add_yield, "pair", **WEAK)],
    store=[threads(layer_energy.add_layer_energy, **NOW, **PAST, **WEAK)],
    condense=[
        blocks(weak_layer.find_support, right="layer_rhs", moved="layer_moved", **SUPPORT, **FACTOR),
        blocks(weak_layer.add_flexibility, tangent="layer_tangent"),
    ],
    keep=[blocks(layer_energy.keep_layer, "pair", **BEFORE, **NOW)],
)
