r"""Notes on pairs on contact-fixed grids: where cells are not fine enough, and where the half-space under them does not
represent the bodies.

Undeformed normal. Error of gaps that are measured along undeformed normals, or nearly so.

A soft surface also moves tangentially, by u_t outwards from under the load, and where the partner is inclined by x/R*
that opens the gap by u_t x/R*. To first order in x/R* this is in the compliance of soft bodies
(`warpffrf.offline.contact.local_mass`). The remainder, of second order, makes the line load at a given approach too
high by up to

    0.7 (b/R*)^2,

b the half-width, 1/R* the relative curvature. Where the first order is missing, as with dynamic local modes, or
incomplete, as on a surface with partners of different curvature, the load is too high by

    error = b^2/(R* H) (0.45 + b/(2 H)) ((nu - 0.3)/0.2)^2,      negligible below nu = 0.3,

since the material displaced from under the load passes sideways through the depth H of the material, u_t ~ delta b/H;
nu is Poisson's ratio; for two soft bodies the mean weighted by (1 - nu^2)/E. Fitted to finite elements with the normal
of the partner (tests/verification, `plane_strain_cover`, bonded inside, R/H 1.4 to 10, b/H 0.1 to 1.3). Point contacts
are not evaluated.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.far_field import ASYMMETRIC, WHOLE
from warpffrf.model.reduced.local_modes import compliance, curvature, leaning
from warpffrf.model.scene import Scene
from warpffrf.online.compile.patches.plan import (
    end_places,
    faces_curve,
    is_crowned,
    rows_follow,
    rows_given,
    stretch_at_start,
    widest,
    widths,
)  # fmt: skip
from warpffrf.online.diagnosis.border_notes import BORDER
from warpffrf.online.diagnosis.patch_off_end import shares_at_ends
from warpffrf.online.history.history import ContactHistory, History
from warpffrf_kernels.rolling.places import LIGHT

FEWEST = 6  # strips, or rows of a point contact, under pressure: with 8 the error of forces is 0.1 %, of peaks 0.9 %
# longest facet edges between two patches: nearer, the error of forces is 1 %; on a sphere, where patches influence each
# other by the mesh alone, the error of this influence is 2 % and more
APART, APART_ON_SPHERES = 1.5, 6.0
ROLLED = 0.1  # of W: with less the contact does not roll
SLOPED = 0.03  # of the length of rows that follow along a profile, without a note
WIDE = 0.9  # of WHOLE: span of a patch without a note
ROUND_OFF = 1e-6  # of W
SHORT = 0.5  # of the half-width: last rows of patches that run off an end, without a note
# half-lengths of the patch of a point contact from an end: nearer, the contribution of the end varies over the patch
CLEAR = 2.0


def cell_notes(contact: Contact, found: ContactHistory, history: History) -> list[str]:
    """Notes on the cells of a pair in a run, `found` in its `history`."""
    cells = found.cells
    if cells is None:
        return []
    notes = []
    last = int(np.argmax(found.pressure.sum(axis=(1, 2))))
    strips = int(np.count_nonzero(found.pressure[last].max(axis=1) > 0.0))
    if strips < FEWEST:
        notes.append(
            f"contact {contact.name!r}: the patch is {strips} cells wide where it is most loaded, under {FEWEST}; use "
            "cells= with more strips across"
        )
    notes += _cut(contact, found)
    travelled = np.abs(cells.column - cells.column[0]).max() * contact.a.surface.grid.pitch
    if contact.law.chi > 0.0 and travelled * arc_per_theta(contact) > ROLLED * float(np.max(cells.half_width)):
        notes.append(
            f"contact {contact.name!r}: the patch rolled over the first body, and its layer is damped by the rate of "
            "depth in each cell of the patch, not at each material point; damping in a rolling contact "
            "wants grid='body_fixed'"
        )
    spans = 2.0 * float(np.max(cells.half_width * _sharpest(contact, found)))
    if spans > WIDE * WHOLE:
        notes.append(
            f"contact {contact.name!r}: the patch spans {spans:.2g} rad of a surface, and the half-space under it is "
            f'flat; beyond {WHOLE:g} rad the error of pressures exceeds 2 %: use grid="body_fixed", with a finer mesh'
        )
    notes += _light(contact, found, history)
    notes += _too_large(contact, found)
    notes += _unsymmetric(contact)
    half_width = strips * float(cells.half_width[last]) / found.pressure.shape[1]
    notes += normal_notes(contact, half_width, {})
    if rows_follow(contact):
        return notes + _along_profile(contact, found) + _near_end(contact, found)
    return notes + _beyond_rows(contact, found) + _over_end(contact, found) + _travelled(contact, found, history)


def _along_profile(contact: Contact, found: ContactHistory) -> list[str]:
    """A patch on an extruded curve whose cells are not about it, or have another shape than at the start."""
    cells, pressed = found.cells, found.pressure > 0.0
    loaded = np.any(pressed, axis=(1, 2))
    if cells is None or not faces_curve(contact) or not loaded.any():
        return []
    notes, middle = [], cells.z.shape[1] // 2
    off = loaded & ~np.any(pressed[:, :, middle], axis=1)
    if off.any():
        notes.append(
            f"contact {contact.name!r}: in {np.count_nonzero(off)} saved rows no pressure acts where the surfaces were "
            "found to be nearest, and few cells carry the load: the search along a hollow profile ended too early; "
            "give the rows, cells=(strips, boundaries)"
        )
    steep = np.hypot(1.0, contact.a.surface.shape.slope_at(cells.z[loaded].mean(axis=1)))
    change = float(np.abs(steep / stretch_at_start(contact) - 1.0).max())
    if change > SLOPED:
        notes.append(
            f"contact {contact.name!r}: the patch moved along the profile of {contact.a.label} to where rows of cells "
            f"are {change:.0%} longer or shorter than at the start, for which the half-space between them is "
            "tabulated: pressures err by about as much; begin the run there, or give the rows, "
            "cells=(strips, boundaries)"
        )
    return notes


def _beyond_rows(contact: Contact, found: ContactHistory) -> list[str]:
    """Given rows, the outermost of which carry pressure: the patch may continue beyond."""
    if not rows_given(contact) or not np.any(found.pressure[:, :, [0, -1]] > 0.0):
        return []
    return [
        f"contact {contact.name!r}: the patch reaches the outermost of the rows given by cells=, and no pressure acts "
        "beyond: extend them"
    ]


def _sharpest(contact: Contact, found: ContactHistory) -> np.ndarray:
    """Largest curvature (T,) [1/m] of the two surfaces under the patch; a rigid free one does not count, nor a second
    helical one. Of a helical first one in the row with the largest pressure."""
    cells = found.cells
    if cells is None:
        return np.zeros(len(found.pressure))
    middle = float(np.mean(np.asarray(contact.a.surface.grid.z)[[0, -1]]))
    highest = np.argmax(found.pressure.max(axis=1), axis=1)
    column = cells.column + cells.row_shift[np.arange(len(highest)), highest]
    sharpest = np.zeros(len(column))
    for port, place in ((contact.a, column), (contact.b, cells.column_second)):
        surface, theta, profile = port.surface, np.zeros(len(column)), port.surface.shape.profile()
        if profile.free and (port.rigid or (profile.twist and port is contact.b)):
            continue
        if profile.free:
            theta = surface.grid.theta_start + surface.grid.pitch * np.asarray(place)
        sharpest = np.maximum(sharpest, np.max(np.abs(surface.shape.curvatures(theta, middle)), axis=0))
    return sharpest


def _light(contact: Contact, found: ContactHistory, history: History) -> list[str]:
    """Where its friction acts on one cell (`warpffrf_kernels.rolling.places`)."""
    forces = {name: np.linalg.norm(other.force, axis=1) for name, other in history.contacts.items()}
    largest, own = np.max(list(forces.values()), axis=0), forces[contact.name]
    light = (own > 0.0) & (own < float(LIGHT) * largest)
    if found.friction is None or not np.any(light):
        return []
    return [
        f"contact {contact.name!r}: in {np.mean(light):.0%} of the saved rows it carries less than {float(LIGHT):.0%} "
        "of the largest load, and its friction acts on one of its cells: its force is complete, its slip and wear are "
        "not resolved"
    ]


def _too_large(contact: Contact, found: ContactHistory) -> list[str]:
    """A patch that is larger than its cells may become; its outermost cells carry the load beyond."""
    cells, p = found.cells, found.pressure
    if cells is None:
        return []
    edge = np.any(p[:, [0, -1]] > 0.0, axis=(1, 2))
    if rows_follow(contact):
        edge |= np.any(p[:, :, [0, -1]] > 0.0, axis=(1, 2))
    cut = edge & (np.asarray(cells.half_width) >= widest(contact) * (1.0 - ROUND_OFF))
    if not cut.any():
        return []
    return [
        f"contact {contact.name!r}: at {np.count_nonzero(cut)} saved steps the patch is larger than its cells may be, "
        f"half-widths of {widest(contact):.3g} m, beyond which the half-space does not represent the bodies: "
        'pressures at its edges, and peak pressures, are too high; use grid="body_fixed", with a finer mesh'
    ]


def _unsymmetric(contact: Contact) -> list[str]:
    """Surfaces with a mesh on which the half-space subtracted from the far field is not symmetric."""
    sides = [(port.label, getattr(port.surface.far, "asymmetry", 0.0)) for port in contact.ports if not port.rigid]
    return [
        f"contact {contact.name!r}: the half-space on the mesh of {label} is not symmetric ({asymmetry:.0%}): forces "
        "of a patch of cells may err by more than 1 %; reduce the body with quadratic cells, or finer and squarer ones "
        "at the surface"
        for label, asymmetry in sides
        if asymmetry > ASYMMETRIC
    ]


def _near_end(contact: Contact, found: ContactHistory) -> list[str]:
    """A point contact so close to an end that the contribution of the end varies over the patch."""
    cells, under = found.cells, np.any(found.pressure > 0.0, axis=1)
    ends = end_places(contact)
    if cells is None or not ends or not under.any():
        return []
    half = 0.5 * np.sum(cells.length * under, axis=1)
    middle = np.sum(cells.z * under, axis=1) / np.maximum(under.sum(axis=1), 1)
    away = np.min([np.abs(middle - end) for end in ends], axis=0)
    near = (half > 0.0) & (away < CLEAR * half)
    if not near.any():
        return []
    closest = float(np.min(away[near]))
    return [
        f"contact {contact.name!r}: the patch comes within {closest:.2g} m of a free end, {CLEAR:g} of its "
        "half-lengths or less; the contribution of the end to its displacement is evaluated in its middle only: use "
        'grid="body_fixed" where the pressure at the end matters'
    ]


def _over_end(contact: Contact, found: ContactHistory) -> list[str]:
    """A crowned line contact that runs off an end, where the last row is long, or the partner extends beyond."""
    cells = found.cells
    if cells is None or not is_crowned(contact):
        return []
    shares = shares_at_ends(found.pressure)
    t, end = np.unravel_index(int(np.argmax(shares)), shares.shape)
    if shares[t, end] <= BORDER:
        return []
    length, strips = float(cells.length[t, -int(end)]), np.count_nonzero(found.pressure[t].max(axis=1) > 0.0)
    half_width = strips * float(cells.half_width[t]) / found.pressure.shape[1]
    if np.ptp(widths(contact)[:, end]) > length:
        return [
            f"contact {contact.name!r}: the patch reaches an end, where one surface ends and the other continues: "
            f"pressure has no bound at a sharp edge, and that of the last row, which had {shares[t, end]:.0%} of the "
            f"largest, is a mean over its {length:.2g} m; force and line loads do not depend on that length"
        ]
    if length <= SHORT * half_width:
        return []
    return [
        f"contact {contact.name!r}: the patch reaches an end, whose last row had {shares[t, end]:.0%} of the largest "
        f"pressure and is {length:.2g} m long, {length / half_width:.2g} of the half-width: a peak at the end is a "
        "mean over the row and may be too low; use more rows in cells=, or let a run begin with this load, "
        "so that rows are fine there"
    ]


def _travelled(contact: Contact, found: ContactHistory, history: History) -> list[str]:
    """A line contact whose partner has moved along the axis: its ends are modelled at their initial positions."""
    a, b = contact.a, contact.b
    ends = hasattr(b.surface.shape, "table") if b.rigid else getattr(b.surface.far, "ends", ())
    if found.cells is None or not ends:
        return []
    own, other = history.bodies[a.body.name], history.bodies[b.body.name]
    place = other.position + np.einsum("tij,j->ti", rot.matrix(other.rotation), b.surface.shape.axis_point)
    seen = np.einsum("tji,tj->ti", rot.matrix(own.rotation), place - own.position)
    at_start = a.body.to_user(b.body.to_world(b.surface.shape.axis_point))
    way = float(np.abs((seen - at_start) @ a.surface.shape.e_a).max())
    if way <= float(found.cells.length.min()):
        return []
    return [
        f"contact {contact.name!r}: body {b.body.name!r} moved {way:.2g} m along the axis, and its free ends are "
        "modelled at their initial positions for the cells: pressures near them are inaccurate; let the body with the "
        'relevant ends be the first of the contact, or use grid="body_fixed"'
    ]


def _cut(contact: Contact, found: ContactHistory) -> list[str]:
    """A note for each surface on whose end across the patch has been cut: cells beyond the outermost columns carry
    no load. Lines of contact on helical surfaces end there.
    """
    cells = found.cells
    if cells is None or not len(cells.column) or contact.a.surface.shape.profile().twist:
        return []
    strips = found.pressure.shape[1]
    offset = np.arange(strips) - 0.5 * (strips - 1)
    pressed = found.pressure.max(axis=2) > 0.0
    notes = []
    for port, column in ((contact.a, cells.column), (contact.b, cells.column_second)):
        grid = port.surface.grid
        if port.rigid or grid is None or grid.periodic:
            continue
        middle = float(np.mean(np.asarray(grid.z)[[0, -1]]))
        shape = port.surface.shape
        metres = grid.pitch * (1.0 if shape.profile().planar else float(shape.radius_at(middle)))
        strip = 2.0 * cells.half_width / (strips * metres)
        x = column[:, None] + strip[:, None] * offset
        beside = (x - strip[:, None] < 0.0) | (x + strip[:, None] > grid.columns - 1)
        if np.any(pressed & beside):
            notes.append(
                f"contact {contact.name!r}: the patch reaches the end of {port.label} across, a spacing of its grid "
                f"({metres:.2g} m) inside the edge of the named facets; the pressure is cut there: where the body "
                "continues, define a larger contact surface"
            )
    return notes


def near_patches(scene: Scene, history: History) -> list[str]:
    """Notes on patches of one surface so near to each other that the mesh is inaccurate between them."""
    sides = [
        (contact, port, side)
        for contact in scene.finite_sliding
        if contact.name in history.contacts and history.contacts[contact.name].cells is not None
        for side, port in enumerate(contact.ports)
        if not port.rigid and not port.surface.half_space
    ]
    notes = []
    for i, (contact, port, side) in enumerate(sides):
        for other, its, there in sides[i + 1 :]:
            if its.body is not port.body or its.name != port.name or other is contact:
                continue
            away = np.abs(_column(history, contact, side) - _column(history, other, there))
            if not len(away):
                continue
            grid = port.surface.grid
            if grid.periodic:
                away = np.minimum(away % grid.columns, grid.columns - away % grid.columns)
            metres = float(away.min()) * grid.pitch * float(port.surface.shape.radius_at(float(np.mean(grid.z))))
            edge = float(port.body.reduced.report["contact"][port.name]["longest_facet_edge"])
            least = APART_ON_SPHERES if port.surface.shape.kind == "sphere" else APART
            if metres < least * edge:
                notes.append(
                    f"contacts {contact.name!r} and {other.name!r}: their patches come within {metres:.2g} m of each "
                    f"other on {port.label}, {metres / edge:.2g} facet edges; nearer than {least:g} the mesh under "
                    "them is too coarse for their mutual influence: use a finer one there"
                )
    return notes


def _column(history: History, contact: Contact, side: int) -> np.ndarray:
    """Column (T,) of the grid on a side at the position of the patch."""
    cells = history.contacts[contact.name].cells
    if cells is None:
        raise TypeError(f"contact {contact.name!r} has no cells")
    return cells.column_second if side else cells.column


def arc_per_theta(contact: Contact) -> float:
    """Metres of arc per unit of theta on the first surface."""
    surface = contact.a.surface
    return float(surface.shape.radius_at(float(np.mean(np.asarray(surface.grid.z)[[0, -1]]))))


MOST = 0.005  # of the line load: a larger error is noted
HARMLESS, SPAN = 0.3, 0.2  # Poisson's ratios from which on u_t counts, and up to that of an incompressible body
SECOND_ORDER = 0.7  # of (b/R*)^2: 0.4 on a rigid roller of the same radius, 0.7 on a plane


def line_load_error(half_width: float, radius: float, wall: float, poisson_ratio: float) -> float:
    """Estimated relative error of the line load at a given approach along undeformed normals; lengths in m."""
    squeezed = (max(poisson_ratio - HARMLESS, 0.0) / SPAN) ** 2
    return half_width**2 / (radius * wall) * (0.45 + 0.5 * half_width / wall) * squeezed


def normal_notes(contact: Contact, half_width: float, taken: Mapping[tuple[int, str], float]) -> list[str]:
    """A note where the error is noticeable in the largest patch of `contact`, of that `half_width` [m]; `taken`: the
    slope that each surface has included in its compliance, by (index of the body, surface).
    """
    relative = sum(curvature(port.surface) for port in contact.ports)
    if not relative > 0.0 or any(port.surface.shape.profile().crown for port in contact.ports):
        return []  # conformal, or a point contact
    error = weight = 0.0
    for port in contact.ports:
        if (share := compliance(port)) == 0.0:
            continue
        known, own = port.body.reduced.provenance, leaning(contact, port)
        nu = known["contact_materials"][port.surface.name]["poisson_ratio"]
        wall = known.get("contact_walls", {}).get(port.surface.name) or 1.0 / relative
        missing = abs(1.0 - taken.get((port.body.index, port.name), 0.0) / own) if own != 0.0 else 1.0
        error += share * missing * line_load_error(half_width, 1.0 / relative, wall, nu)
        weight += share
    error = error / weight + SECOND_ORDER * (half_width * relative) ** 2 if weight > 0.0 else 0.0
    if error <= MOST:
        return []
    return [
        f"contact {contact.name!r}: the patch reaches {half_width * relative:.2g} of the relative radius to either "
        "side, and gaps follow the slope of the deformed surfaces to first order at most: the load of a line at a "
        f"given approach is up to {error:.1%} too high"
    ]
