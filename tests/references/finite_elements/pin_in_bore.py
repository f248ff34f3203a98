r"""A pin pressed into a bore of nearly its own radius: full finite elements compared with Persson's solution.

The pin (radius R, about (dR, 0), where it touches) and the sleeve (bore R + dR about the origin) are both modelled in
plane strain by `contact`, with the true bore: a pin node at R (cos t, sin t) + (dR, 0) has the gap
R + dR - |x| under the normal x/|x|. The sleeve is fixed at its outer radius. The pin either floats on a uniform body
force (`held=False`, with a hole so small that it is negligible) or its inner circle moves as a rigid one (True, a
roller on its shaft). Either body may be rigid (material None).

Persson's plate has no outer edge and his gap is linear in dR/R: both differences appear in the tables, the first by
the outer radius, the second by the clearance.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from references.closed_forms import LineContact, conformal_by_half_angle, contact_modulus
from references.finite_elements.contact import HalfRing, Solved, active_set, pressure_rows, quadratic_rows
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.material import Material
from warpffrf.study.markdown import table

Array = np.ndarray
STEEL = Material(210e9, 0.3, 7800.0, name="steel")
GROWTH = 1.25  # of cells away from the patch
MARGIN = 1.35  # half-angles within which nodes can carry pressure and cells are fine
LARGEST = np.deg2rad(8.0)  # of a cell far from the patch
MADE = "Made by `python -m references.finite_elements.pin_in_bore`; do not edit.\n"


def graded(first: float, length: float, largest: float = np.inf, growth: float = GROWTH) -> Array:
    """Positions 0 ... length whose spacing grows by `growth` from about `first` to at most `largest`."""
    steps = [first]
    while sum(steps) < length:
        steps.append(min(steps[-1] * growth, largest))
    places = np.append(0.0, np.cumsum(steps))
    return places * (length / places[-1])


@dataclass(frozen=True)
class Pin:
    """Lengths [m]: radius R, clearance dR, inner radius of the pin, outer of the sleeve; materials, None: rigid."""

    radius: float = 0.01
    clearance: float = 1e-5
    inner_radius: float = 1e-4
    outer_radius: float = 0.2
    pin: Material | None = STEEL
    bore: Material | None = STEEL
    held: bool = False


def solve_pin(case: Pin, load: float, half_angle: float, cells: float = 32.0) -> Solved:
    """The loaded pin. load P' [N/m] of the whole pin; half_angle [rad] expected, `cells` in it: for the mesh only."""
    require_number(load, "load", positive=True)
    if case.pin is None and case.bore is None:
        raise InputError("pin in bore: both bodies are rigid, give one of them a material")
    R, bore = case.radius, case.radius + case.clearance
    h = half_angle / cells
    fine = h * np.arange(int(np.ceil(MARGIN * cells)) + 1)
    if fine[-1] > 0.9 * np.pi:
        raise InputError(f"pin in bore: half-angle {half_angle:g} is too large for this mesh")
    angles = np.append(fine, fine[-1] + graded(h * GROWTH, np.pi - fine[-1], LARGEST)[1:])
    nodes = np.empty(2 * len(fine) - 1)
    nodes[::2], nodes[1::2] = fine, 0.5 * (fine[1:] + fine[:-1])
    x = np.stack([R * np.cos(nodes) + case.clearance, R * np.sin(nodes)], axis=1)
    reach = np.linalg.norm(x, axis=1)
    e = x / reach[:, None]
    A = np.zeros((len(nodes), len(nodes)))
    if case.pin is not None:
        depth = graded(R * h, R - case.inner_radius)
        ring = HalfRing(case.pin, np.sort(R - depth), angles)
        _, dofs = ring.on_circle(R)
        E = np.zeros((ring.basis.N, len(nodes)))
        for k in range(2):
            E[dofs[: len(nodes), k], np.arange(len(nodes))] = e[:, k]
        inner, fixed = ring.on_circle(case.inner_radius)
        if not case.held:
            E -= np.outer(ring.body_force(), e[:, 0])
            fixed = fixed[:1, 0]  # one point, without load
        A += ring.flexibility(E, np.ravel(fixed))
    if case.bore is not None:
        depth = graded(R * h, case.outer_radius - bore)
        ring = HalfRing(case.bore, bore + depth, angles)
        places, dofs = ring.on_circle(bore)
        rows = quadratic_rows(places, np.arctan2(x[:, 1], x[:, 0]))
        E = np.zeros((ring.basis.N, len(nodes)))
        for k in range(2):
            E[dofs[:, k]] = rows.T * e[:, k]
        A += ring.flexibility(E, np.ravel(ring.on_circle(case.outer_radius)[1]))
    B = pressure_rows(nodes, R)
    s, gap, delta, sets = active_set(A, bore - reach, e[:, 0], B, 0.5 * load)
    return Solved(fine, s, gap, delta, sets)


def errors(case: Pin, half_angle: float, cells: float) -> list[float]:
    """Errors of peak pressure and moment angle against Persson, and the two nodes between which the patch ends over
    his half-angle [rad], at the load that gives it."""
    if case.pin is None:
        raise InputError("pin in bore: the closed form wants an elastic pin")
    exact = conformal_by_half_angle(half_angle, case.radius, case.clearance, case.pin, case.bore)
    found = solve_pin(case, exact.load, half_angle, cells)
    return [
        found.peak_pressure / exact.peak_pressure - 1.0,
        found.moment_angle / exact.moment_angle - 1.0,
        *(place / half_angle for place in found.edge),
    ]


def _row(name: list[str], e: list[float]) -> list[str]:
    return [*name, f"{e[0]:+.2%}", f"{e[1]:+.2%}", f"{e[2]:.3f} to {e[3]:.3f}"]


def page() -> str:
    """The whole page."""
    degrees = (10.0, 30.0, 60.0)
    mesh, outer, bodies, hertz = [], [], [], []
    for ratio in (1e-3, 1e-2):
        for degree in degrees:
            for cells in (8, 16, 32):
                e = errors(Pin(clearance=0.01 * ratio), np.deg2rad(degree), cells)
                mesh.append(_row([f"{ratio:g}", f"{degree:g}°", str(cells)], e))
    for outside in (2.0, 5.0, 10.0, 20.0):
        e = errors(Pin(outer_radius=0.01 * outside), np.deg2rad(30.0), 16)
        outer.append(_row([f"{outside:g} R"], e))
    for degree in degrees:
        bodies.append(_row([f"{degree:g}°"], errors(Pin(bore=None), np.deg2rad(degree), 16)))
    for degree in (1.0, 5.0, *degrees, 80.0):
        exact = conformal_by_half_angle(np.deg2rad(degree), 0.01, 1e-5, STEEL, STEEL)
        line = LineContact(exact.load, 0.01 * 0.01 / 1e-5, contact_modulus(STEEL, STEEL))
        width, peak = line.half_width / 0.01 / exact.half_angle - 1.0, line.peak_pressure / exact.peak_pressure - 1.0
        ratio = exact.load / (exact.modulus * exact.clearance)
        hertz.append(
            [f"{degree:g}°", f"{ratio:.5f}", f"{exact.peak_pressure / 1e6:.3f}", f"{width:+.1%}", f"{peak:+.1%}"]
        )
    shown = ["peak pressure", "moment angle", "end of the patch"]
    return f"""# A pin in a bore of nearly its own radius

{MADE}
Persson's conformal solution, from its integral equation (`closed_forms/conformal.py`), and a full finite element
solution of both bodies in plane strain with quadratic cells, no modes (`finite_elements/contact.py`): steel, R = 10 mm,
no friction. Loads are those that give the half-angle by Persson. *Moment angle*: twice the root of the second moment of
the pressure over the angle, the same measure of both; *end of the patch*: the two hats between which it ends, over the
half-angle.

## Finite elements against Persson, under refinement

Clearance over R, half-angle, cells in the half-angle; sleeve of 20 R.

{table(["clearance", "half-angle", "cells", *shown], mesh)}
What stays at the larger clearance is geometry: Persson's gap is of first order in it, the model's is the true one.

A sleeve that is not infinite (30°, clearance 1e-3, 16 cells), held at its outer radius:

{table(["outer radius", *shown], outer)}
A rigid bore, against the same integral equation for unlike bodies (clearance 1e-3, 16 cells):

{table(["half-angle", *shown], bodies)}
## Where Hertz ends

P'/(E* dR), peak pressure at clearance 1e-3 in MPa, and the error of Hertz's line contact at that load.

{table(["half-angle", "load", "peak [MPa]", "Hertz half-width", "Hertz peak"], hertz)}"""


def main(folder: str = "docs/studies") -> None:
    """Write the page."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    (Path(folder) / "pin_in_bore.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
