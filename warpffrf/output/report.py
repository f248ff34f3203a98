"""The readable report of a run."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.report_items import item_lines


def report_text(result: Any) -> str:
    """Status, counters, contacts at the last saved step beside Hertz, joints, forces, sensors, energy balance, notes:
    plain text, one fact a line."""
    history = result.history
    lines = [f"status            {result.status}" + (f": {result.message}" if result.message else "")]
    if len(result.time) == 0:
        return "\n".join([*lines, "no step was saved", *_notes(history)])
    lines.append(f"time              {result.time[0]:.6g} to {result.time[-1]:.6g} s, {len(result.time)} rows saved")
    if len(history.iterations) > 1:
        every_step = history.counters.get("steps", 0) <= len(history.iterations) - 1  # else rows sum over steps
        lines.append(
            f"newton            mean {history.iterations[1:].mean():.2f}, "
            f"largest {int(history.iterations[1:].max())} iterations a {'step' if every_step else 'saved row'}"
        )
    lines += [f"{name.replace('_', ' '):<17} {value:.6g}" for name, value in history.counters.items()]
    for name in result.contact_names:
        lines += _contact_lines(result.contact(name))
    lines += item_lines(result)
    lines.append(f"energy scale      {result.energy_scale:.6g} J, the largest energy at hand")
    residual = result.energy_residual
    if np.all(np.isnan(residual)):
        lines.append("energy residual   not booked by this method")
    else:
        lines.append(
            f"energy residual   {residual[-1]:+.3e} at the end, {np.ptp(residual):.3e} peak to peak, over the energy "
            "scale"
        )
    defect = history.energy.get("contact_grid")
    if result.contact_names and defect is not None and result.energy_scale > 0.0 and np.isfinite(defect[-1]):
        lines.append(
            f"contact grid      {defect[-1] / result.energy_scale:+.3e} of the energy scale moved by the grid defect"
        )
    return "\n".join([*lines, *_notes(history)])


def _contact_lines(contact: Any) -> list[str]:
    head = f"contact '{contact.name}'"
    if contact.line_load[-1] <= 0.0:
        return [f"{head}: open in the last row"]
    lines = [
        f"{head}: last row",
        f"  force           {contact.force_magnitude[-1]:.6g} N",
        f"  half-width      {contact.half_width[-1] * 1e6:.5g} um",
        f"  peak pressure   {contact.mid_peak_pressure[-1] / 1e6:.5g} MPa at mid-width, "
        f"{contact.peak_pressure[-1] / 1e6:.5g} MPa anywhere",
        f"  active modes    {int(contact.active_modes[-1])}",
    ]
    try:
        line = contact.hertz(-1)
    except InputError as error:
        return [*lines, f"  Hertz           not computed: {error}"]
    return [
        *lines,
        f"  Hertz           half-width {line.half_width * 1e6:.5g} um, peak {line.peak_pressure / 1e6:.5g} MPa "
        f"at the line load {line.line_load / 1e3:.5g} N/mm found at mid-width",
    ]


def _notes(history: Any) -> list[str]:
    return ["notes"] + [f"  - {note}" for note in history.notes] if history.notes else []
