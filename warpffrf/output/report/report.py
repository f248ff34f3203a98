"""The readable report of a run."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.budget.budget import budget_text
from warpffrf.output.budget.figures import UNKNOWN, figure_text
from warpffrf.output.contact.hertz import flexible_sides, hertz
from warpffrf.output.contact.hertz_patch import HertzPoint
from warpffrf.output.report.counters import counter_lines
from warpffrf.output.report.figures import LENGTH, SHARE, idle_energy, without_round_off
from warpffrf.output.report.fold import Block, Pairs, folded, folded_notes
from warpffrf.output.report.items import item_lines, same_surfaces

KINDS = {
    "line": "a line across the width",
    "line_around": "a line along the arc",
    "point": "a point contact",
    "flat": "flat faces",
}

CARRIERS = {"hats": "nodes of the contact grid", "cells": "cells of the patch"}


def report_text(result: Any, progress: bool = False, pairs: Pairs = "folded") -> str:
    """Status, counters, contacts at the last saved step beside Hertz, joints, forces, sensors, energy balance, notes:
    plain text, one fact a line. progress: that of the error budget, which may be made here. pairs: alike things
    "folded" into one, or "all" (`fold`)."""
    if pairs not in get_args(Pairs):
        raise InputError(f"report: pairs is {pairs!r}; known: {', '.join(map(repr, get_args(Pairs)))}")
    history = result.history
    lines = [f"status            {result.status}" + (f": {result.message}" if result.message else "")]
    if len(result.time) == 0:
        return "\n".join([*lines, "no step was saved", *_notes(history, pairs)])
    lines.append(f"time              {result.time[0]:.6g} to {result.time[-1]:.6g} s, {len(result.time)} rows saved")
    lines += counter_lines(history)
    lines += [f"{file.what:<17} {file}" for file in result.written]
    contacts = [
        Block(name, _contact_lines(result.contact(name)), same_surfaces(result.view.pairs[name]))
        for name in result.contact_names
    ]
    lines += [line for block in folded(contacts, "contact", pairs) for line in block]
    lines += item_lines(result, pairs)
    lines.append(f"energy scale      {result.energy_scale:.6g} J, the largest energy at hand")
    residual, idle = result.energy_residual, idle_energy(result)
    if result.energy_scale <= idle:
        lines.append(
            "energy residual   no share is told: nothing moves, the energies are round-off of forces times lengths, "
            f"{idle:.2g} J"
        )
    else:
        lines.append(
            f"energy residual   {residual[-1]:+.3e} at the end, {np.ptp(residual):.3e} peak to peak, over the energy "
            "scale"
        )
    defect = history.energy.get("contact_grid")
    friction = history.energy.get("friction")
    if friction is not None and np.any(np.nan_to_num(friction) != 0.0):
        lines.append(f"friction          {friction[-1]:+.6g} J, work of friction since the start")
    if result.contact_names and defect is not None and result.energy_scale > idle and np.isfinite(defect[-1]):
        lines.append(
            f"contact grid      {defect[-1] / result.energy_scale:+.3e} of the energy scale, moved because patches "
            "travel over nodes of finite spacing"
        )
    return "\n".join([*lines, *_budget_lines(result, progress, pairs), *_notes(history, pairs)])


def _budget_lines(result: Any, progress: bool, pairs: Pairs) -> list[str]:
    """The error budget, made here where it has not been and can be."""
    lines = result.error_budget(progress=progress)
    if len(lines) == 1 and lines[0].source == UNKNOWN:
        return [f"error budget      {lines[0].basis}"]
    kinds: dict[str, list[Block]] = {}
    for owner, line in figure_text(lines):
        kind, _, name = owner.partition(" '")
        kinds.setdefault(kind, []).append(Block(name.rstrip("'"), [line]))
    figures = [f"  {block[0]}" for kind, blocks in kinds.items() for block in folded(blocks, kind, pairs)]
    return [*budget_text(lines), "errors of figures   all sources together, and the largest of them", *figures]


def _contact_lines(contact: Any) -> list[str]:
    head = f"contact '{contact.name}'"
    friction = _friction_lines(contact) if contact.has_friction else []
    if not contact.touching[-1]:
        return [f"{head}: open in the last row", *friction]
    width, middle = contact.half_widths[-1] * 1e6, without_round_off(contact.center_of_pressure[-1], LENGTH) * 1e6
    lines = [
        f"{head}: last row, {KINDS[contact.patch_kind]}",
        f"  force           {contact.force_magnitude[-1]:.6g} N",
        f"  half-width      {contact.half_width[-1] * 1e6:.5g} um",
        f"  patch           {width[0]:.5g} um along the arc, {width[1]:.5g} um along the axis, area "
        f"{contact.patch_area[-1] * 1e6:.5g} mm2, centre at {middle[0]:.4g} and {middle[1]:.4g} um",
        f"  peak pressure   {contact.mid_peak_pressure[-1] / 1e6:.5g} MPa {_section(contact)}, "
        f"{contact.peak_pressure[-1] / 1e6:.5g} MPa anywhere",
        f"  approach        {without_round_off(contact.approach[-1], LENGTH) * 1e6:.5g} um",
        f"  loaded          {int(contact.active_hats[-1])} {CARRIERS[contact.loaded]}",
    ]
    try:
        found = hertz(contact, -1)
    except InputError as error:
        return [*lines, f"  Hertz           not computed: {error}", *_stress_lines(contact), *friction]
    if isinstance(found, HertzPoint):
        a, b = found.semi_axes
        values = f"semi-axes {a * 1e6:.5g} and {b * 1e6:.5g} um, peak {found.peak_pressure / 1e6:.5g} MPa, approach "
        values += f"{found.approach * 1e6:.5g} um at the load {found.load:.5g} N found"
    else:
        values = f"half-width {found.half_width * 1e6:.5g} um, peak {found.peak_pressure / 1e6:.5g} MPa "
        values += f"at the line load {found.line_load / 1e3:.5g} N/mm found at mid-width"
    return [*lines, f"  Hertz           {values}", *_stress_lines(contact), *friction]


def _stress_lines(contact: Any) -> list[str]:
    """How right stresses below a line contact are, of bodies that have them."""
    with_stress = {body.name for body, _ in flexible_sides(contact.view) if body.reduced.stress}
    if contact.patch_kind != "line" or not with_stress:
        return []
    return [
        f"  stress below    {e.reason}"
        if e.reason
        else f"  stress below    of '{name}' von Mises to {e.von_mises:.1%}, its depth to {e.depth:.0%} "
        f"({e.spacings:.2g} spacings of nodes in the half-width)"
        for name, e in contact.stress_errors(-1).items()
        if name in with_stress
    ]


def _section(contact: Any) -> str:
    return "through the centre" if contact.patch_kind == "point" else "at mid-width"


def _friction_lines(contact: Any) -> list[str]:
    friction = contact.friction
    shares = friction.stick_area[-1], friction.slip_area[-1]
    creepage, warning = without_round_off(friction.creepage[-1], SHARE), friction.warning()
    force, moment = friction.tangential_force[-1], friction.spin_moment[-1]
    force, moment = (without_round_off(value, SHARE * contact.force_magnitude[-1]) for value in (force, moment))
    spin = without_round_off(friction.spin_creepage[-1], SHARE)
    rolls, per_metre = "not rolling", "not rolling"
    if not np.any(np.isnan(creepage)):
        rolls = f"{creepage[0]:+.4e} longitudinal, {creepage[1]:+.4e} lateral, {spin:+.4e} rad/m of spin"
        per_metre = (
            f"{friction.t_gamma[-1]:.5g} N by forces and creepages, {friction.power_per_metre[-1]:.5g} N by the "
        )
        per_metre += "friction power over the rolling speed"
    adhesion = f", area of adhesion {shares[0] / sum(shares):.0%}" if sum(shares) > 0.0 else ""
    lines = [
        f"  traction        {np.linalg.norm(force):.6g} N tangential, "
        f"{friction.traction_coefficient[-1]:.5g} of the load",
        f"  creep forces    Fx {force[0]:+.5g} N longitudinal, Fy {force[1]:+.5g} N lateral, "
        f"Mz {moment:+.4g} N m of spin, on '{contact.view.first_body.name}'",
        f"  creepage        {rolls}",
        f"  T-gamma         {per_metre}",
        f"  stick, slip     {shares[0] * 1e6:.5g} and {shares[1] * 1e6:.5g} mm2{adhesion}",
        f"  friction power  {friction.power[-1]:.5g} W, largest of the run {np.nanmax(friction.power):.5g} W",
        f"  wear index      {friction.wear_peak[-1] / 1e6:.5g} W/mm2 at most, {friction.wear_rate[-1]:.5g} W in all "
        "(pressure times slip speed)",
        f"  cells a step    {friction.cells_per_step[-1]:.3g}, largest of the run "
        f"{np.nanmax(friction.cells_per_step):.3g}",
    ]
    return lines if warning is None else [*lines, f"  warning         {warning}"]


def _notes(history: Any, pairs: Pairs) -> list[str]:
    return ["notes"] + [f"  - {note}" for note in folded_notes(history.notes, pairs)] if history.notes else []
