r"""Quality of a reduced body: quantities that are measured or derived. `quality` collects them as plain data for
`ReducedBody.report["quality"]`.

**Frequencies covered.** A basis that contains the vibration modes `V` of the FE model exactly and is M-orthonormalised
has them among its Ritz pairs. The rest of its span is M-orthogonal to them, so every other Ritz frequency lies above
the first omitted vibration mode. The lowest `v` frequencies of the body are therefore the FE model's own, and the
range is covered up to `max_frequency`, or up to the last of them if the number of modes was the limit.

**Mass captured.** The body is base-excited at an interface. The relative motion is approximated in the space that
keeps the interface at rest: with rigid motion `a` about the interface point and modes `q`,

    a + Phi_I q = 0   =>   (a, q) = V q,   V = [-Phi_I; 1],   Phi_I (6, m) interface motion of the modes,
    M_r = diag(J, 1),   J (6, 6) rigid mass matrix about the interface point.

A rigid motion `r` of the base excites `Gamma = V^T M_r (r, 0) = -Phi_I^T J r`; the part of the body's inertia `r^T J r`
represented by the space is the sum of its effective masses,

    captured = Gamma^T (V^T M_r V)^-1 Gamma / (r^T J r) = 1 - r^T (J^-1 + Phi_I Phi_I^T)^-1 r / (r^T J r),

the second form by the Woodbury identity. It requires 6x6 matrices only and shows what is missing: `(J^-1 + Phi_I
Phi_I^T)^-1` is the effective mass at the interface at infinite frequency. With all modes of the mesh it is the mass of
the interface itself (Craig and Kurdila 2006, "Fundamentals of Structural Dynamics", 17.6, for effective masses). For
interfaces that deform ("average", "free") it is the mean motion that is constrained.

**Static completeness.** The response `u` to a unit load `f` is exact in theory; `|P f - K u| / |P f|` is the error of
the solver and of the inertia relief. A path measures it on a sample of loads (`sampled_residual`) and reports the
largest as the fact `worst_load_residual`. The loss without local modes is the share of a grid node's own compliance,
`C_res,ii / C_ii`, that the global modes do not represent.

**Coupling of contact surfaces.** Own and cross residual compliances are one Gram matrix, so that an entry between
nodes i and j of two contact grids is at most the geometric mean of their own. The largest ratio, 0 to 1, measures the
coupling of the surfaces beyond the global modes.

**Error of the contact grid.** Hertz's pressure `p = sqrt(1 - (x/a)^2)` across the columns, the same in all rows,
interpolated by the shape functions of the present spacing (cells: their means), is replaced by the combination of
functions of twice the spacing that is nearest in energy; these are combinations of the fine ones, the columns of `P`.
The energy lost,

    e = 1 - b^T (P^T C P)^-1 b / (p^T C p),   b = P^T C p,

is measured with the body's own compliance `C` of a window. The error at the present spacing is estimated as `e/4`: the
energy error decreases with the third power of the spacing (square-root ends of p in the norm of order -1/2), by a
factor of eight per halving, of which the fine functions' own coarseness hides about half. On a half-plane, with four
spacings to the half-width, the estimate is 1.1 to 1.2 times the true error of the same position; for cells the worst
position has 1.5 times the error of the best. Only the grid is assessed: errors of the mesh are additional.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.contact_surface import ContactSurface, CrossCompliance
from warpffrf.model.reduced.file import stored_arrays
from warpffrf.offline.bases.modes import SAME_FREQUENCY, whole_multiples
from warpffrf.offline.elastic import Array, ElasticModel
from warpffrf.offline.products import Limits, SurfaceProduct

# bases that contain the vibration modes of the free body, so that a covered range can be stated
HOLDS_VIBRATIONS = ("free_free", "craig_chang", "trial_vector_derivatives")
HALF_WIDTH = 4  # spacings per half-width of the pressure used to assess the grid: a typical, well resolved patch
LEAST_COLUMNS = 7  # of a window: three coarse shape functions with their supports; smaller grids are not assessed
SAMPLED = 16  # unit loads of a surface whose residual is measured: they cost one block of solutions
HELD = 1e-12  # of the largest compliance of a pair of nodes: smaller values are round-off (nodes on a rigid interface)
HALVING = 4.0  # energy lost by doubling the spacing, relative to the error at the present one (module docstring)


def quality(body: ReducedBody, surfaces: Sequence[SurfaceProduct], limits: Limits) -> dict[str, Any]:
    """Plain data for `body.report["quality"]`; `surfaces` in the order of `body.contact_surfaces`.

    Reads `dependent_directions_dropped`, `worst_load_residual`, `basis` and `inertia` in `body.report`, if present.
    """
    named = list(zip(body.contact_surfaces.values(), surfaces, strict=True))
    frequencies = covered_frequencies(body, limits)
    return {
        "frequencies": frequencies,
        "captured": {name: captured(body, name) for name in body.interfaces},
        "static": {
            "worst_load_residual": body.report.get("worst_load_residual"),
            "local_share": {s.name: local_share(p.window, p.residual_window) for s, p in named},
        },
        "membrane": body.report.get("inertia", {}).get("membrane"),
        "contact_grid": {s.name: _judged_grid(s, p) for s, p in named},
        "memory": memory(body),
        "truncated": _truncated(body, limits, frequencies),
    }


def covered_frequencies(body: ReducedBody, limits: Limits) -> dict[str, Any]:
    """The vibration modes of the FE model that the basis contains (module docstring), frequencies in Hz.

    `covered` is None if the basis does not contain vibration modes by construction, 0 if none were requested.
    """
    f = body.frequencies
    asked = None if limits.omega_max is None else limits.omega_max / (2.0 * np.pi)
    kind = body.report.get("basis", {}).get("kind", HOLDS_VIBRATIONS[0])
    found: dict[str, Any] = {
        "modes": len(f),
        "first": float(f[0]) if len(f) else None,
        "highest": float(f[-1]) if len(f) else None,
        "max_frequency": asked,
        "modes_asked": limits.count,
        "vibration_modes": None,
        "last_vibration": None,
        "covered": None,
    }
    if kind not in HOLDS_VIBRATIONS:
        return found
    below = 0 if limits.none else len(f)
    if asked is not None:
        below = min(below, int(np.sum(f <= asked * (1.0 + SAME_FREQUENCY))))
    kept = below if limits.count is None else whole_multiples(f[:below], limits.count)
    kept = min(body.report.get("basis", {}).get("vibration_modes", kept), len(f))  # if the basis counted them
    found["vibration_modes"] = kept
    found["last_vibration"] = float(f[kept - 1]) if kept else None
    # not limited by the number of modes: all modes up to max_frequency are present
    found["covered"] = asked if asked is not None and kept == below else (found["last_vibration"] or 0.0)
    return found


def rigid_mass(body: ReducedBody, point: Array) -> Array:
    """J (6, 6): mass matrix of the rigid body for translation [m] and rotation [rad] at `point` (3,) [m], user axes.

    J = [[m 1, -m c~], [m c~, I + m (c.c 1 - c c^T)]] with c the centre of mass relative to `point`.
    """
    c = body.center_of_mass - point
    cross = body.mass * np.array([[0.0, -c[2], c[1]], [c[2], 0.0, -c[0]], [-c[1], c[0], 0.0]])
    about = body.inertia + body.mass * (c @ c * np.eye(3) - np.outer(c, c))
    return np.block([[body.mass * np.eye(3), -cross], [cross, about]])


def captured(body: ReducedBody, name: str) -> dict[str, list[float]]:
    """Fractions of the mass (x, y, z) and of the moments of inertia about the interface point (x, y, z) that move in
    the reduced model with interface `name` constrained (module docstring)."""
    interface = body.interfaces[name]
    J = rigid_mass(body, interface.point)
    scale = 1.0 / np.sqrt(np.diag(J))  # makes kg and kg m2 comparable before the inversion
    B = interface.modes / scale  # columns to coordinates with unit diagonal mass
    unit = J * np.outer(scale, scale)
    felt = np.linalg.inv(np.linalg.inv(unit) + B.T @ B)
    share = 1.0 - np.diag(felt) / np.diag(unit)
    return {"mass": share[:3].tolist(), "inertia": share[3:].tolist()}


def load_residual(model: ElasticModel, loads: Array, response: Array) -> float:
    """Largest `|P f - K u| / |P f|` over the columns f of `loads` (n, h) and u of `response` (n, h), the whole static
    response of the reduced model by its global and local modes."""
    balanced = model.self_equilibrated(loads)
    size = np.linalg.norm(balanced, axis=0)
    rest = np.linalg.norm(balanced - model.K @ response, axis=0)
    return float(np.max(rest[size > 0.0] / size[size > 0.0], initial=0.0))


def sampled_residual(
    model: ElasticModel, loads: Any, flexibility: Callable[[Array], Array] | None = None, *, count: int = SAMPLED
) -> float:
    """`load_residual` of `count` evenly spread columns of `loads` (n, h), dense or sparse.

    Their whole response is `flexibility(loads)` (None: the model's own), from which the residual local modes are
    formed: the part of the global modes is subtracted from it and added again.
    """
    chosen = np.unique(np.linspace(0, loads.shape[1] - 1, min(count, loads.shape[1])).round().astype(int))
    f = loads[:, chosen]
    f = f.toarray() if hasattr(f, "toarray") else np.asarray(f)
    return load_residual(model, f, (flexibility or model.flexibility)(f)) if f.shape[1] else 0.0


def local_share(window: Array, residual_window: Array) -> float:
    """Largest share (0 to 1) of a node's own compliance contributed by the local modes: `window` (h, h) with and
    `residual_window` (h, h) without the part of the global modes."""
    return float(np.max(np.diag(residual_window) / np.diag(window)))


def coupling(cross: CrossCompliance, target: ContactSurface, source: ContactSurface) -> float:
    """Largest |D_ts,ij| / sqrt(D_tt,ii D_ss,jj) of grid nodes of two contact surfaces: from 0, where their local modes
    are uncoupled, to 1, for nodes on the same facets. Nodes that hardly move, on a rigid interface, do not count.
    """
    own = []
    for side, s in ((1, target), (2, source)):
        of_sector = np.sqrt(np.maximum(np.diag(s.lags[0]), 0.0))
        own.append(np.resize(of_sector, cross.lags.shape[side]))
    scale = np.multiply.outer(*own)
    moved = scale > HELD * scale.max()
    return float(np.max(np.abs(cross.lags[:, moved]) / scale[moved]))


def grid_error(
    window: Array, rows: int, *, kind: str = "nodes", half_width: int = HALF_WIDTH
) -> tuple[float, int] | None:
    """Estimated relative error of the compliance energy of Hertz's pressure on this grid, and the corresponding
    half-width in spacings: `half_width`, or less if the window is narrower. None for a window of fewer than
    `LEAST_COLUMNS` columns.

    `window` (w rows, w rows): compliance of neighbouring columns of functions of `kind`, per coefficient. See the
    module docstring.
    """
    columns = len(window) // rows
    if columns < LEAST_COLUMNS:
        return None
    p, around, half = COARSER[kind](columns, half_width)
    C = window[: len(p) * rows, : len(p) * rows]
    p, P = np.repeat(p, rows), np.kron(around, np.eye(rows))
    load = C @ p
    b = P.T @ load
    lost = 1.0 - b @ np.linalg.solve(P.T @ (C @ P), b) / (p @ load)
    return max(float(lost), 0.0) / HALVING, half


def _coarser_nodes(columns: int, half_width: int) -> tuple[Array, Array, int]:
    """Hertz's pressure at the nodes (n,) of the first `columns` or one less, linear shape functions of twice the
    spacing (n, m) with supports inside, and the half-width in spacings."""
    middle = (columns - 1) // 2
    half = min(half_width, middle - 1)
    offset = np.arange(-middle, middle + 1)
    centers = offset[(offset % 2 == 0) & (np.abs(offset) < middle)]
    p = np.sqrt(np.maximum(0.0, 1.0 - (offset / half) ** 2))
    return p, np.maximum(0.0, 1.0 - 0.5 * np.abs(offset[:, None] - centers)), half


def _coarser_cells(columns: int, half_width: int) -> tuple[Array, Array, int]:
    """The same for cells, two of which make one of twice the spacing: means of Hertz's pressure, centred on an edge.

    With x = sin t the integral of sqrt(1 - x^2) is (t + sin t cos t)/2.
    """
    pairs = columns // 4 * 2  # an even number: the middle is an edge of the coarse cells too
    half = min(half_width, pairs)
    t = np.arcsin(np.clip(np.arange(-pairs, pairs + 1) / half, -1.0, 1.0))
    p = half * np.diff(0.5 * (t + np.sin(t) * np.cos(t)))
    return p, np.kron(np.eye(pairs), np.ones((2, 1))), half


COARSER = {"nodes": _coarser_nodes, "cells": _coarser_cells}


def _judged_grid(surface: ContactSurface, product: SurfaceProduct) -> dict[str, float] | None:
    """Estimated error, the corresponding half-width [m] and the spacing [m] of the columns; None if not assessed."""
    found = grid_error(product.window, surface.grid.rows, kind=surface.grid.kind)
    if found is None:
        return None
    z = surface.grid.z
    spacing = float(surface.grid.pitch * surface.shape.radius_at(0.5 * (z[0] + z[-1])))
    return {"error": found[0], "half_width": found[1] * spacing, "spacing": spacing}


def memory(body: ReducedBody) -> dict[str, int]:
    """Bytes of every array of the body, by its path, without compression; the largest first."""
    sizes = {path: int(array.nbytes) for path, array in stored_arrays(body).items()}
    return dict(sorted(sizes.items(), key=lambda item: -item[1]))


def _truncated(body: ReducedBody, limits: Limits, frequencies: dict[str, Any]) -> list[str]:
    """The parts of the FE model that the reduced body omits, and the reasons."""
    texts = []
    if limits.none:
        texts.append("all vibration modes, because neither max_frequency nor modes requested any")
    elif frequencies["covered"] is None:
        texts.append("vibration modes as such: the basis is of another kind and states no range of frequencies")
    elif frequencies["covered"] == frequencies["max_frequency"]:
        texts.append(f"vibration modes above {frequencies['covered']:.6g} Hz, the requested max_frequency")
    elif limits.count is not None and frequencies["vibration_modes"] >= limits.count:
        texts.append(
            f"vibration modes above {frequencies['covered']:.6g} Hz, because modes={limits.count} was requested"
        )
    if dropped := body.report.get("dependent_directions_dropped", 0):
        texts.append(f"{dropped} direction(s) of the global basis, because the others contain them already")
    if left_out := body.report.get("basis", {}).get("derivatives_left_out"):
        texts.append(
            "of the trial vector derivatives of the joint, in energy norm, {:.2%} of the normal and {:.2%} of the "
            "tangential ones".format(*left_out)
        )
    for s in body.contact_surfaces.values():
        if not s.grid.periodic:
            texts.append(
                f"the outermost columns at the two ends of the arc of contact surface {s.name!r}, because their "
                "supports would leave it"
            )
    if body.contact_surfaces:
        texts.append("digits of the displayed local displacement beyond single precision, to halve the file")
    return texts
