r"""Errors of bodies: inertia terms that were left out, and local modes without inertia.

*Inertia*: sizes of the terms on the motion found (`online.diagnosis.indicator`). *Stiffening* by turning is of the size
of the deformed inertia. *Local modes* follow the contact force at once, although modes above the highest global one,
omega_c, would follow it with their inertia: of a force F(t) they miss F''/omega_c^2 at most, so that the root mean
square of F'' over that of omega_c^2 F is the part of the local deformation, and so of the approach, that is wrong.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.online.diagnosis.indicator import term_sizes
from warpffrf.online.engine import Engine
from warpffrf.online.history.budget_line import BudgetLine

INERTIA, STIFFENING, LOCAL = "inertia terms", "geometric stiffening", "local modes without inertia"
STATIC = "quasi_static"
LEAST_ROWS = 5  # for second differences of a force
UNEVEN = 1e-6  # of the distance of saved steps


def inertia_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """For each flexible body, of its deformation."""
    scene, bodies = result.history.scene, result.history.bodies
    levels = {body.name: plan.level for body, plan in zip(scene.bodies, engine.compiled.inertia.bodies, strict=True)}
    sizes = term_sizes(scene, bodies, levels)
    lines = []
    for body in scene.bodies:
        own = [s for s in sizes if s.body == body.name]
        if not own:
            continue
        of = f"deformation of body {body.name!r}"
        left_out = [s for s in own if not s.kept]
        if left_out:
            names = ", ".join(s.term for s in left_out)
            size = float(min(np.linalg.norm([s.size for s in left_out]), 1.0))
            lines.append(BudgetLine(INERTIA, of, size, f"{names}, on the motion found", "inertia='full'"))
        softened = next((s.on_modes for s in own if s.term == "deformed inertia"), 0.0)
        if not body.stiffening:
            cure = "stiffening=True in reduce and add_body"
            lines.append(BudgetLine(STIFFENING, of, float(min(softened, 1.0)), "as the deformed inertia", cure))
    return lines


def local_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """For each contact that was loaded, of its approach."""
    if engine.compiled.local.options.treatment != STATIC:
        return []
    lines = []
    for contact in result.history.scene.contacts:
        found = result.contact(contact.name)
        if not np.any(found.touching):
            continue
        of = f"approach of contact {contact.name!r}"
        cure = "modes of the bodies to a higher max_frequency, or local='hht'"
        highest = [highest_frequency(port.body) for port in (contact.a, contact.b) if not port.rigid]
        size, basis = _missed(result.time, found.force, min(highest))
        lines.append(BudgetLine(LOCAL, of, size, basis, cure))
    return lines


def highest_frequency(body: Any) -> float:
    """Up to where [Hz] the global modes of a body hold its vibrations; 0 without any."""
    known = body.reduced.report.get("quality", {}).get("frequencies", {}).get("covered")
    frequencies = body.reduced.frequencies
    return float(known or (frequencies[-1] if len(frequencies) else 0.0))


def _missed(time: np.ndarray, force: np.ndarray, highest: float) -> tuple[float, str]:
    if highest == 0.0:
        return np.nan, "a body has no vibration modes, which would say what their inertia does"
    step = np.diff(time)
    if len(time) < LEAST_ROWS or np.ptp(step) > UNEVEN * step.max():
        return np.nan, "needs a force saved at even times"
    bend = np.diff(force, 2, axis=0) / step[0] ** 2
    size = np.sqrt(np.mean(np.sum(bend**2, axis=1)) / np.mean(np.sum(force**2, axis=1)))
    return float(size / (2.0 * np.pi * highest) ** 2), f"how fast the force changes, beside {highest:.4g} Hz"
