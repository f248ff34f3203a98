"""Lines of the report on lumped contacts, oil films, laps, joints, force elements and sensors: where each ended, and
the largest on the way."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.scene_view import PairView
from warpffrf.output.report.figures import FORCE, LENGTH, SHARE, largest_force, without_round_off
from warpffrf.output.report.fold import Block, Pairs, folded

STICK = 1  # state of friction
MOST_LINES = 20  # of one kind: a report is read on one screen


def item_lines(result: Any, pairs: Pairs = "folded") -> list[str]:
    """One line a lumped contact, oil film, joint, force element and sensor of a run with saved rows, and some of each
    lap; alike ones as one, and at most `MOST_LINES` of a kind, unless `pairs` is "all". Stresses are left out: they are
    evaluated when they are asked for."""
    history = result.history
    beside = max(largest_force(history), *(_largest_torque(getattr(history, kind)) for kind in ("joints", "forces")))
    kinds = {
        "lumped contact": {
            name: Block(name, [_lumped(name, contact)], same_surfaces(result.view.lumped[name]))
            for name, contact in history.lumped_contacts.items()
        },
        "film": {name: Block(name, [_film(name, film, history.time)]) for name, film in history.films.items()},
        "lap": {name: Block(name, _lap(result.lap(name))) for name in result.lap_names},
        "joint": {name: Block(name, [_joint(name, joint, beside)]) for name, joint in history.joints.items()},
        "force": {name: Block(name, [_force(name, force, beside)]) for name, force in history.forces.items()},
        "sensor": {name: Block(name, [_sensor(name, sensor)]) for name, sensor in history.sensors.items()},
    }
    found: list[str] = []
    for kind, blocks in kinds.items():
        lines = [line for block in folded(list(blocks.values()), kind, pairs) for line in block]
        more = 0 if pairs == "all" else max(len(lines) - MOST_LINES, 0)
        found += lines[: len(lines) - more]
        found += [f'... and {more} more lines of {kind}s; report(pairs="all") has them'] if more else []
    return found


def _largest_torque(owners: dict[str, Any]) -> float:
    """[N m] of joints or forces, as a force with an arm of 1 m."""
    return max((float(np.max(np.abs(one.torque), initial=0.0)) for one in owners.values()), default=0.0)


def same_surfaces(view: PairView) -> str:
    """What pairs must have in common to be alike, whatever they are called: shapes and radii of both surfaces, and
    friction."""
    shapes = [f"{type(surface.shape).__name__} {surface.shape.radius:.9g}" for surface in (view.first, view.second)]
    return f"{shapes} {view.friction}"


def _size(vectors: Any, unit: str, beside: float = 0.0) -> str:
    """The length of a vector (T, 3) at the end, and its largest; `beside`: what it is round-off of where it is SHARE of
    that, a force [N] of the machine, as a torque with an arm of 1 m."""
    lengths = without_round_off(np.linalg.norm(vectors, axis=1), max(FORCE, SHARE * beside))
    return f"{lengths[-1]:.5g} {unit} (largest {np.max(lengths):.5g})"


def _joint(name: str, joint: Any, beside: float) -> str:
    line = f"joint '{name}': reaction {_size(joint.force, 'N', beside)}, {_size(joint.torque, 'N m', beside)}"
    for coordinate in joint.names:
        unit = "rad" if coordinate.endswith("rotation") else "m"
        line += f"; {coordinate.replace('_', ' ')} {joint.named(coordinate)[-1]:.6g} {unit}"
    return line


def _lumped(name: str, contact: Any) -> str:
    line = f"lumped contact '{name}': force {_size(contact.force, 'N')}"
    approach = without_round_off(contact.approach, LENGTH) * 1e6
    line += f"; approach {approach[-1]:.5g} um (largest {np.max(approach):.5g})"
    if np.any(contact.friction_force != 0.0):
        line += f"; friction {_size(contact.friction_force, 'N')}, slip {_size(contact.slip_velocity, 'm/s')}"
    if np.any(contact.moment != 0.0):
        line += f"; moment against rolling and pivoting {_size(contact.moment, 'N m')}"
    return line


def _film(name: str, film: Any, time: Any) -> str:
    pressure, gap, power = film.largest_pressure * 1e-6, film.smallest_gap * 1e6, film.friction_power
    line = f"film '{name}': force {_size(film.force, 'N')}"
    line += f"; peak pressure {pressure[-1]:.5g} MPa (largest {np.max(pressure):.5g})"
    line += f"; smallest film {gap[-1]:.5g} um (least {np.min(gap):.5g})"
    line += f"; friction power {power[-1]:.5g} W (largest {np.max(power):.5g})"
    if np.any(np.isnan(film.feed_flow)):
        return line
    return line + f"; feeds {_mean(film.feed_flow, time) * 1e6:.5g} cm3/s on average"


def _lap(lap: Any) -> list[str]:
    """Force and pressure, cells by state, what slid and what that took, and what makes it uncertain."""
    force, peak = lap.normal_force, lap.largest_pressure * 1e-6
    count, area = lap.counts[-1], lap.slip_area * 1e6
    line = f"lap '{lap.name}': normal force {force[-1]:.5g} N (largest {np.max(force):.5g})"
    line += f"; peak pressure {peak[-1]:.5g} MPa (largest {np.max(peak):.5g})"
    line += f"; of {lap.cells} cells {count[0]} open, {count[1]} stick, {count[2]} slip"
    ratio = lap.shift_distance / lap.size
    row, cell = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
    slid, turned = (np.linalg.norm(values[-1]) for values in (lap.sliding, lap.turning))
    zone = lap.slip_zone()
    slips = (
        f"  slid            largest {lap.shift_distance[row, cell] * 1e6:.5g} um, {ratio[row, cell]:.2g} of the cell"
    )
    slips += f"; as a whole {slid * 1e6:.5g} um and {turned:.3g} rad at the end"
    warnings = [f"  warning         {warning}" for warning in lap.warnings()]
    if lap.friction == 0.0:
        return [line, slips, *warnings]
    slips += f"; slipping area {area[-1]:.5g} mm2 (largest {np.max(area):.5g})"
    across = f", {zone.across:.2g} across" if np.isfinite(zone.across) else ""
    loss = f"  loss            {lap.loss[-1]:.5g} J by friction, in {zone.cells} cells{across}"
    return [line, slips, loss, *warnings]


def _mean(values: Any, time: Any) -> float:
    """Mean over the run of values (T,) that are straight between the saved times (T,) [s]."""
    span = time[-1] - time[0]
    return float(np.trapezoid(values, time) / span if span > 0.0 else np.mean(values))


def _force(name: str, force: Any, beside: float) -> str:
    line = f"force '{name}': {_size(force.force, 'N', beside)}, {_size(force.torque, 'N m', beside)}"
    if force.friction is None:
        return line
    ends = "sticks" if force.friction.state[-1] == STICK else "slips"
    return f"{line}; {ends} at the end, stuck in {np.mean(force.friction.state == STICK):.3g} of the saved rows"


def _sensor(name: str, sensor: Any) -> str:
    last = ", ".join(f"{c} {v:.5g}" for c, v in zip(sensor.components, np.asarray(sensor.values)[-1], strict=True))
    return f"sensor '{name}' [{sensor.unit}]: {last}"
