r"""Energy and dissipation of layers between surfaces (`weak_layer`), and the history of damped ones.

Energy. The contact energy includes int W(d) dA (instead of s.(E s)/2, which the solution's own sum counts). A damped
layer dissipates the work of its drag p - P_elastic(d), taken, like that of all forces, with the mean of both ends of
the step (for an impulsive pair that of `impulsive_contact`), int (drag_0 + drag_1)/2 (d_1 - d_0) dA, at least zero; the
drag has the sign of the rate, also if the pressure is cut at zero: a surface that returns more slowly than it is
released dissipates the energy left in the layer. It is booked with the damping.

Rates. A damped layer requires the depth of every point at the last accepted state. It is stored with the cell, that is
with the material of the first surface, and read at the present position of the window. Without pressure, the depth is
that left by the gap: y(0) minus the mean opening of the surrounding nodes, at least zero. In rolling, the material
enters the patch and leaves it, so a damped layer dissipates energy in steady rolling as well; its pressure, shifted
towards the inlet, acts along normals that intersect the axes of both bodies and cannot brake them (rolling resistance
requires the slope of the deformed surface, which small displacements do not include). That energy has no source and is
part of the contact grid's line of the ledger.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry, LayerScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import CONSTANT
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.core.state import ContactState, LayerState
from warpffrf_kernels.impulsive.impulsive_means import has_converged
from warpffrf_kernels.layers.layer_laws import CHI, layer_depth, layer_energy, layer_pressure
from warpffrf_kernels.layers.weak_layer import cell_exists, corner_of, linear_yield, node_value, point_area, rate_of
from warpffrf_kernels.normal.pair_forces import mean_of

wp.set_module_options(MODULE_OPTIONS)

FAR = wp.constant(wp.float64(1.0e300))  # m: opening without an opposite surface


@kernel
def add_layer_energy(
    run: Run, geometry: ContactGeometry, contact: ContactState, fields: ContactFields, layers: LayerScratch,
    impulses: ImpulsiveContact,
):  # fmt: skip
    """Per world, one lane, if the iteration has converged: the energy of the layers instead of that counted by
    `sum_contact`, depths and drags of damped ones, and their dissipation in the step [J]."""
    w = wp.tid()
    model = run.models[w]
    if not has_converged(run.ctl, w):
        return
    pair = int(0)
    while pair < model.pairs.count:
        if model.elements[0].layers.kind[pair] != CONSTANT:
            energy = real(0.0)
            lost = real(0.0)
            part = real(0.5)
            if contact.impulsive[w, pair] != 0:
                part = impulses.theta[w, pair]
            A = model.pairs.first[pair]
            rows = model.surfaces.rows[A]
            start = model.elements[0].layers.point_start[pair]
            per_column = model.elements[0].layers.point_count[pair]
            low = geometry.window[w, pair, 0] + model.window.half
            high = geometry.window[w, pair, 1] + model.window.half
            m = low * rows
            while m < (high + 1) * rows:
                if contact.active[w, pair, m] != 0 and geometry.area[w, pair, m] > real(0.0):
                    value = linear_yield(model, w, pair, m, rows, contact, layers)
                    energy -= real(0.5) * contact.pressure[w, pair, m] * value
                m += 1
            damped = model.elements[0].layers.number[pair, CHI] > real(0.0)
            rate = rate_of(model, run, w, pair)
            origin = geometry.center[w, pair, 0] - 1 - model.window.half
            if damped:
                q = int(0)
                while q < layers.layer_now.shape[2]:
                    layers.layer_now[w, pair, q] = real(0.0)
                    layers.layer_drag_now[w, pair, q] = real(0.0)
                    q += 1
            q = low * per_column
            while q < (high + 2) * per_column:
                cell = q / per_column
                point = start + q - cell * per_column
                row = model.elements[0].layers.row[point]
                p = real(0.0)
                slack = real(0.0)
                own = int(0)
                for node in range(4):
                    m = corner_of(model, cell, row, rows, node)
                    if m >= 0:
                        value = node_value(model, node, point)
                        if value > real(0.5):
                            own = m
                        if contact.active[w, pair, m] != 0:
                            p += value * wp.max(contact.pressure[w, pair, m], real(0.0))
                        elif geometry.area[w, pair, m] > real(0.0):
                            slack += value * wp.max(fields.opened[w, pair, m], real(0.0)) / geometry.area[w, pair, m]
                        else:
                            slack = FAR
                if (p > real(0.0) or damped) and cell_exists(model, A, origin + cell):
                    d = layer_depth(model, pair, p, layers.layer_past[w, pair, q], rate)
                    if damped:
                        if p <= real(0.0):
                            d = wp.max(d - slack, real(0.0))
                        layers.layer_now[w, pair, q] = d
                    dA = point_area(model, w, pair, point, own, geometry.area)
                    energy += dA * layer_energy(model, pair, d)
                    if rate > real(0.0):
                        elastic = layer_pressure(model, pair, d, real(0.0), real(0.0))
                        layers.layer_drag_now[w, pair, q] = p - elastic[0]
                        mean = mean_of(part, layers.layer_past_drag[w, pair, q], p - elastic[0])
                        lost += dA * wp.max(
                            mean * (d - layers.layer_past[w, pair, q]), real(0.0)
                        )  # below where the rate changes sign
                q += 1
            contact.pair_energy[w, pair, 1] = contact.pair_energy[w, pair, 1] + energy
            impulses.pair_loss[w, pair] = lost
        pair += 1


@kernel
def keep_layer(run: Run, geometry: ContactGeometry, layers: LayerScratch, layer: LayerState):
    """Per (world, pair), lanes over points: stores depths and drags of an accepted step, with the columns they belong
    to."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].accept == 0 or run.ctl[w].mode == k.PROJECT:
        return
    if model.elements[0].layers.kind[pair] != CONSTANT and model.elements[0].layers.number[pair, CHI] > real(0.0):
        q = lane
        while q < layer.layer_depth.shape[2]:
            layer.layer_depth[w, pair, q] = layers.layer_now[w, pair, q]
            layer.layer_drag[w, pair, q] = layers.layer_drag_now[w, pair, q]
            q += wp.block_dim()
    if lane == 0:
        layer.layer_column[w, pair] = geometry.center[w, pair, 0]
