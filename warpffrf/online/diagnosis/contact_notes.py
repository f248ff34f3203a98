"""What a reader of a run should know of its contacts before trusting their pressures.

Each note names the pair, what was seen, and the cure: a patch of too few columns of the contact grid, hats that reach
over the end of the second surface, patches that reach an end (`border_notes`), axes that turned against each other,
surfaces that overlapped at the start, and energy that came from nowhere.

Skew. A pair on the line of centres takes the section of the second body as a circle. Where its axis is turned by an
angle e that section is an ellipse, of the curvature cos(e)^2/R_B on its side: with like radii the relative curvature is
too large by e^2/2. Pairs that begin skewed have their gaps taken at points; one that turns in the run keeps its family.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.placement.gap import smallest_gap
from warpffrf.model.reduced.slopes import leanings
from warpffrf.model.scene import Scene
from warpffrf.online.diagnosis.border_notes import border_notes
from warpffrf.online.diagnosis.cell_notes import arc_per_theta, cell_notes, near_patches
from warpffrf.online.diagnosis.undeformed_normal import normal_notes
from warpffrf.online.diagnosis.untouched import CELLS, SHALLOW, loaded_contacts, untouched_notes
from warpffrf.online.history.history import ContactHistory, History
from warpffrf.online.history.interface_motion import turned

AT_POINTS = 'give the contact kinematics="closest_point"'
FEWEST_COLUMNS = 4  # across the largest patch: with fewer, peaks and half-widths are those of the grid
CUT = 0.05  # of the load: hats that hang over the end of the second surface by more are worth a word
GAINED = 0.01  # of the largest energy at hand: what a run may gain without a word
TAKEN = 0.01  # the same of what the integrator takes
LEAST_TILT = 1e-7  # rad: less is round-off of poses
MOMENT_LEFT = 0.01  # of the moment of a pair on the line of centres
MOST_SKEW = 0.07  # rad: e^2/2 is 0.25 %; measured against gaps at points: force 0.1 %, peak pressure 0.2 % up to there


def contact_notes(scene: Scene, history: History, on_axes: Collection[str] = ()) -> list[str]:
    """Notes on the patches of all pairs of a run; `on_axes`: names of those whose gaps are taken along the line of
    centres."""
    notes = []
    taken = leanings(scene.contacts)
    for contact in loaded_contacts(scene, history):
        found = history.contacts[contact.name]
        columns = _widest(found)
        if found.cells is not None:
            notes += cell_notes(contact, found, history)
            continue
        notes += _coarse(contact, columns) + _cut(contact, found) + border_notes(contact, found, history.time)
        notes += normal_notes(contact, 0.5 * columns * contact.a.surface.grid.pitch * arc_per_theta(contact), taken)
        if contact.name in on_axes:
            notes += _skewed(contact, found, history)
    return notes + near_patches(scene, history) + untouched_notes(scene, history)


def _skewed(contact: Contact, found: ContactHistory, history: History) -> list[str]:
    loaded = np.any(found.pressure > 0.0, axis=(1, 2))
    angles = angle_between_axes(contact, history)[loaded]
    if angles.max() <= MOST_SKEW:
        return _tilted(contact, found, history)
    return [
        f"contact {contact.name!r}: the axes of the two surfaces turned against each other by up to "
        f"{angles.max():.3g} rad, more than the {MOST_SKEW:g} that gaps along the line of centres are good for, and "
        f"pressures are wrong by the order of {0.5 * angles.max() ** 2:.1%}; {AT_POINTS}"
    ]


def _tilted(contact: Contact, found: ContactHistory, history: History) -> list[str]:
    """Gaps along lines of centres leave out R_B tilt^2/2, and so the moment R_B tilt F, where axes lean towards each
    other; said where it is a noticeable part of the moment of the pair."""
    lean = Leaning.of(contact, found, history)
    if lean.left <= MOMENT_LEFT * lean.moment:
        return []
    return [
        f"contact {contact.name!r}: the axes of the two surfaces lean towards each other by up to {lean.tilt:.2g} rad; "
        f"gaps along the line of centres leave about {lean.left:.2g} N m of the moment out that this gives, of "
        f"{lean.moment:.2g} N m in all; {AT_POINTS} where that matters"
    ]


@dataclass(frozen=True)
class Leaning:
    """Where axes that lean towards each other by `tilt` [rad] leave most out: R_B tilt F, the moment `left` [N m] out
    of a pair on lines of centres, beside its `moment` [N m] and its `force` [N]."""

    tilt: float
    left: float
    moment: float
    force: float

    @classmethod
    def of(cls, contact: Contact, found: ContactHistory, history: History) -> Leaning:
        """In a run of some rows."""
        force, moment = np.linalg.norm(found.force, axis=1), np.linalg.norm(found.torque, axis=1)
        tilt = _tilt(contact, found, history)
        left = force * float(contact.b.surface.shape.radius) * np.where(tilt > LEAST_TILT, tilt, 0.0)
        at = int(np.argmax(left))
        return cls(float(tilt[at]), float(left[at]), float(moment[at]), float(force[at]))


def _tilt(contact: Contact, found: ContactHistory, history: History) -> np.ndarray:
    """(T,) rad, by which the axes lean towards each other along the normal."""
    axes = [turned(history.bodies[port.body.name].rotation, port.surface.shape.e_a) for port in (contact.a, contact.b)]
    normal = found.force / np.maximum(np.linalg.norm(found.force, axis=1), 1e-300)[:, None]
    return np.abs(np.subtract(*(np.einsum("ti,ti->t", normal, axis) for axis in axes)))


def angle_between_axes(contact: Contact, history: History) -> np.ndarray:
    """Angle (T,) [rad] in [0, pi/2] between the axes of the two surfaces of a pair in a run."""
    a, b = (turned(history.bodies[port.body.name].rotation, port.surface.shape.e_a) for port in (contact.a, contact.b))
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.abs(np.einsum("ti,ti->t", a, b)))


def _widest(found: ContactHistory) -> int:
    """Columns of the grid under pressure in the saved step with the largest load."""
    load = found.pressure.sum(axis=(1, 2))
    return int(np.count_nonzero(found.pressure[int(np.argmax(load))].max(axis=1) > 0.0))


def _coarse(contact: Contact, columns: int) -> list[str]:
    """Sizes: docs/studies/contact_grid.md, worst positions at one to two spacings in a half-width."""
    if columns >= FEWEST_COLUMNS:
        return []
    return [
        f"contact {contact.name!r}: the patch is {columns} columns of the grid wide where it is most loaded, under "
        f"{FEWEST_COLUMNS}: peak pressures and half-widths may be off by a third (points: by a half and more), forces "
        f"at a given approach by a twentieth (points: by a tenth); use a finer mesh (half_width=), {CELLS}"
    ]


def _cut(contact: Contact, found: ContactHistory) -> list[str]:
    """Pressures times the areas of their hats against the normal force: they agree on parts that face each other."""
    surface, other = contact.a.surface, contact.b.surface
    if surface.shape.side < 0.0 or other.shape.side < 0.0:
        return []  # conformal: the pressures' directions differ
    areas = surface.grid.pitch * surface.gram_z.sum(axis=0)
    last = int(np.argmax(found.pressure.sum(axis=(1, 2))))
    pressed = float(found.pressure[last].sum(axis=0) @ areas)
    force = float(np.linalg.norm(found.force[last]))
    if found.friction is not None:
        cells = surface.tangential.grid
        sizes = cells.pitch * np.diag(cells.gram_z(surface.shape))
        rubbed = np.einsum("djk,k->d", found.friction.traction[last], sizes)
        force = float(np.sqrt(max(force**2 - rubbed @ rubbed, 0.0)))
    if pressed <= (1.0 + CUT) * force:
        return []
    return [
        f"contact {contact.name!r}: pressures of the first surface reach over the end of the second, their integral is "
        f"{pressed / max(force, 1e-300):.2f} of the normal force; name the narrower surface first, or give the first "
        "finer rows there"
    ]


def overlap_notes(scene: Scene) -> list[str]:
    """Pairs whose surfaces lie in one another at the initial poses, so that a run from there begins with a push."""
    notes = []
    for contact in scene.contacts:
        try:
            gap = smallest_gap(contact)[0]
        except InputError:  # the surfaces do not face each other
            continue
        if -gap > SHALLOW * float(contact.a.surface.shape.radius):
            notes.append(
                f"contact {contact.name!r}: the run starts with an overlap of {-gap:.3g} m, pressed together at once; "
                "scene.close_gap(contact, along=...) or start='equilibrium' would not"
            )
    return notes


def energy_notes(energy: dict[str, np.ndarray], nothing: float) -> list[str]:
    """Notes where the ledger shows energy that nothing supplied, or that the integrator took: numerical and
    contact-grid lines together rose by more than `GAINED` of the largest of the other lines, the numerical one fell by
    more than `TAKEN` of it. `nothing` [J] is no more than round-off."""
    if not len(energy["kinetic"]):
        return []
    left_out = ("potential", "numerical", "contact_grid")  # the zero of the potential is arbitrary
    lines = [np.abs(values) for name, values in energy.items() if name not in left_out]
    hand = float(np.max(lines)) if lines else 0.0
    defect = energy["numerical"] + energy["contact_grid"]
    gained = float(np.max(defect - np.minimum.accumulate(defect)))
    taken = float(np.max(np.maximum.accumulate(energy["numerical"]) - energy["numerical"]))
    notes = []
    if gained > max(GAINED * hand, nothing):
        notes.append(
            f"the run gained {gained:.3g} J, {gained / max(hand, 1e-300):.1%} of the largest energy of the ledger, "
            "that nothing supplied (ledger lines numerical and contact grid): use a smaller step, step_error=, or "
            "initial velocities that agree with the drives"
        )
    if taken > max(TAKEN * hand, nothing):
        notes.append(
            f"the integrator took {taken:.3g} J, {taken / max(hand, 1e-300):.1%} of the largest energy of the ledger "
            "(ledger line numerical), from motions that the step does not resolve: use a smaller step, step_error=, or "
            "less numerical damping (rho_inf=)"
        )
    return notes
