"""Interactions that may share two surfaces: those that do not define the same unknown twice.

Interactions add their loads to the surfaces and read their displacements, so that several may share two surfaces: a
coating and asperities, each with its own pressure p_i(depth). Where a gap is closed without a law, its pressure is the
constraint force; of two such pressures only the sum is determined. The same holds for two tractions that both constrain
a cell to stick. A film occupies the whole gap: asperities in addition are one of its laws, and a second film cannot use
its grid.

Overlap. Initial overlap of the surfaces of a contact beyond that of elastic bodies.

A contact may start with an interference: it prescribes an approach, which deformation accommodates. Its depth is that
of a Hertz contact, (a/R)^2 R = (pi p0 / 2 E*)^2 R with the relative radius R: 3e-3 R at p0 = 4 GPa between steel balls,
where raceways are permanently indented. Much more indicates a misplaced body; the run would diverge at the
start.

Unreachable contacts. Contacts that will hardly close: too far apart, not facing each other, or kept apart by the
joints.

Joints keep a contact apart where every free motion of its two bodies moves each surface in itself: a rotation about the
axis of a surface of revolution, a translation along a plane. The check uses the rigid motions z that the joints leave,
C z = 0, less those motions of the surfaces in themselves: nothing must remain.

Wedge. Overlaps at the start that no small motion opens: a body wedged between its partners, or all around in a bore.

With g_k the gaps at points k of all pairs, L their gradients by the rigid coordinates z of the bodies and C those of
the joints and drives, the overlap that remains for any small motion of the bodies is -t of the linear programme

    maximise t,      g_k + L_k z >= t,      C z = 0,      |z| <= MOVED times the deepest overlap.

Its multipliers are forces at these points in mutual equilibrium: the pairs with nonzero ones are those that wedge. An
overlap that a motion opens has none. Deformation accommodates a small wedge, as an interference fit; a deep one is a
body in the wrong position, or of the wrong size.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import null_space, orth
from scipy.optimize import linprog

from warpffrf.model.bodies import SurfacePort
from warpffrf.model.checks.redundancy import held_motions, scene_length
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.films import Film
from warpffrf.model.placement.gap import GapSamples, Nearest, closing_direction, facing_gap, gap_samples, moved_body

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene


def refuse_double_claims(contact: Any, others: Iterable[Any]) -> None:
    """Raises `InputError` where `contact`, distributed or lumped, or a film, defines the same unknown as another one on
    its surfaces."""
    for other in others:
        if other is contact:
            continue
        _refuse_beside_film(contact, other)
        if isinstance(contact, Film) or not on_same_surfaces(contact, other):
            continue
        where = (
            f"contact {contact.name!r}: {contact.a.label} and {contact.b.label} are in contact already, as "
            f"{other.name!r}"
        )
        if not (isinstance(contact, Contact) and isinstance(other, Contact)):
            raise InputError(f"{where}; one contact covers all patches between them, in either order")
        if contact.law.curve is None and other.law.curve is None:
            raise InputError(
                f"{where}; one contact covers all patches between them, in either order. A second one requires a law "
                "with a compliance (wf.laws): the pressures of two unilateral contacts are not unique"
            )
        if contact.friction.acts and other.friction.acts:
            raise InputError(
                f"{where}, and both have friction: where both stick, their tractions are not unique; give friction to "
                "one of them"
            )


def refuse_claims_of(scene: Any) -> None:
    """The same for all contacts and films of a scene: laws may have been changed since they were added."""
    contacts = (*scene.finite_sliding, *scene.lumped_contacts, *scene.films)
    for number, contact in enumerate(contacts):
        refuse_double_claims(contact, contacts[:number])
    for number, contact in enumerate(scene.small_sliding):
        refuse_double_small_sliding(contact, scene.small_sliding[:number])


def _refuse_beside_film(one: Any, other: Any) -> None:
    """Raises `InputError` where one of the two is a film whose surfaces, or whose grid, the other one uses too."""
    if isinstance(one, Film) and isinstance(other, Film):
        if _same_surface(one.a, other.a):
            raise InputError(
                f"{one.label}: on the grid of {one.a.label} there is {other.label} already; a surface carries one "
                "film; use a separate surface for a second one"
            )
    elif isinstance(one, Film) or isinstance(other, Film):
        film, contact = (one, other) if isinstance(one, Film) else (other, one)
        if on_same_surfaces(film, contact):
            raise InputError(
                f"contact {contact.name!r} and {film.label} act on the same two surfaces, {film.a.label} and "
                f"{film.b.label}; give the film a law for asperities instead of an additional contact: Film(..., "
                "mixed=films.MixedLubrication(asperities=...))"
            )


def refuse_double_small_sliding(contact: Contact, others: Iterable[Contact]) -> None:
    """Raises `InputError` where another small-sliding contact has the same faces."""
    for other in others:
        if other is not contact and len(other.ports) == len(contact.ports) and on_same_surfaces(contact, other):
            raise InputError(
                f"{contact.label}: {' and '.join(port.label for port in contact.ports)} are joined already, as "
                f"{other.label}; one contact has all of their cells"
            )


def on_same_surfaces(a: Any, b: Any) -> bool:
    """Whether two contacts have the same two surfaces, in either order."""
    return all(any(_same_surface(port, used) for used in b.ports) for port in a.ports)


def _same_surface(a: SurfacePort, b: SurfacePort) -> bool:
    return a.body is b.body and a.name == b.name


OVERLAP_FRACTION = 1e-2  # of the smallest radius of curvature: three times the limit of steel (above); 0.4 mm of 50 mm
FLAT = 1e-9  # of 1 over the width; a smaller curvature counts as zero


def allowed_overlap(contact: Contact, theta: float, z: float) -> float:
    """Depth [m] by which the surfaces may overlap at the start: the value of the pair, or OVERLAP_FRACTION of the
    smallest radius of curvature of the two at chart coordinates theta, z of the first; between planes, of the width."""
    if contact.overlap is not None:
        return contact.overlap
    first, second = contact.a, contact.b
    there = second.body.to_user(first.body.to_world(first.surface.shape.point(theta, z)))
    places = ((first.surface.shape, theta, z), (second.surface.shape, *second.surface.shape.chart(there)[:2]))
    curvature = max(float(np.max(np.abs(shape.curvatures(t, s)))) for shape, t, s in places)
    width = float(np.ptp(first.surface.grid.z))
    return OVERLAP_FRACTION / curvature if curvature * width > FLAT else OVERLAP_FRACTION * width


def refuse_overlap(scene: Scene) -> None:
    """Raises `InputError` for a pair whose surfaces overlap at the initial pose by more than is allowed, with the depth
    and the cure."""
    gaps = {contact.name: facing_gap(contact) for contact in scene.finite_sliding}
    for contact in scene.finite_sliding:
        gap, theta, z = gaps[contact.name] or (0.0, 0.0, 0.0)
        allowed = excessive_overlap(contact, gap, theta, z)
        if allowed is not None:
            if (wedge := find_wedge(scene, gaps)) is not None and (said := excessive_wedge(wedge)):
                raise InputError(said)
            along = closing_direction(contact, theta, z)
            cure = f" with scene.close_gap(pair, along={along})" if along else ""
            raise InputError(
                f"contact {contact.name!r}: the surfaces {contact.a.label} and {contact.b.label} overlap at the start "
                f"by {-gap:.3g} m, more than the {allowed:.3g} m that are allowed; move "
                f"{moved_body(contact).name!r}{cure}, or allow it with Contact(..., overlap={-1.05 * gap:.2g})"
            )


def excessive_wedge(wedge: Wedge) -> str:
    """Message on a wedge deeper than the allowed overlap of its contacts; else ""."""
    allowed = min(allowed_overlap(c, *near[1:]) for c in wedge.contacts if (near := facing_gap(c)) is not None)
    if wedge.depth <= allowed:
        return ""
    return str(wedge) if wedge.all_round else f"{wedge}; {allowed:.3g} m are allowed, or Contact(..., overlap=)"


def excessive_overlap(contact: Contact, gap: float, theta: float, z: float) -> float | None:
    """The allowed overlap [m] where the smallest gap `gap` [m], at theta, z of the first surface, exceeds it; else
    None."""
    if gap >= 0.0:
        return None
    allowed = allowed_overlap(contact, theta, z)
    return allowed if -gap > allowed else None


MOVES = 1e-6  # of a motion of length one: smaller ones count as zero


def out_of_reach(scene: Scene, gaps: dict[str, Nearest | None]) -> list[str]:
    """One message per such pair; `gaps`: `facing_gap` by the name of the pairs to check."""
    told, free = [], None
    for contact in scene.finite_sliding:
        if contact.name not in gaps or contact.meeting is not None:  # teeth that are to meet later
            continue
        near, size = gaps[contact.name], _size(contact)
        said = f"contact {contact.name!r}: {contact.a.label} and {contact.b.label}"
        if near is None:
            told.append(
                f"{said} do not face each other anywhere; move a body, or use the other side (Bore for Cylinder)"
            )
        elif near[0] > OVERLAP_FRACTION * size:
            free = _free_motions(scene) if free is None else free
            if _held_apart(contact, free, scene_length(scene)):
                told.append(
                    f"{said} are {near[0]:.3g} m apart, and the joints allow neither body to move towards the other; "
                    "check radii and positions, or free a joint"
                )
            elif near[0] > size:
                told.append(
                    f"{said} are {near[0]:.3g} m apart at the start, more than the {size:.3g} m radius of the smaller "
                    "one; check radii, positions and units (m), or use scene.close_gap(pair, along=...)"
                )
    return told


def _size(contact: Contact) -> float:
    """The smaller radius [m] of the two surfaces; a plane has none but its half length."""
    sizes = []
    for port in contact.ports:
        surface = port.surface
        if not surface.shape.profile().planar:
            sizes.append(float(surface.shape.radius))
        elif surface.shape.profile().free:
            sizes.append(0.5 * surface.shape.size)
        elif surface.grid is not None:
            sizes.append(float(np.max(np.abs(surface.grid.theta))))
    return min(sizes)


def _free_motions(scene: Scene) -> np.ndarray:
    """Rigid motions (6 bodies, n) that joints and drives leave free, rotations scaled by the length of the scene."""
    held = held_motions(scene)
    return null_space(held) if len(held) else np.eye(held.shape[1])


def _held_apart(contact: Contact, free: np.ndarray, length: float) -> bool:
    """Whether all `free` motions of the two bodies move each surface in itself."""
    for port in contact.ports:
        if port.on_ground:
            continue
        at = 6 * port.body.index
        own = orth(_in_itself(port, length))
        motion = free[at : at + 6]
        if np.abs(motion - own @ (own.T @ motion)).max(initial=0.0) > MOVES:
            return False
    return True


def _in_itself(port: SurfacePort, length: float) -> np.ndarray:
    """Motions (6, n) of the body of a surface that map the surface onto itself: translations, rotations."""
    body, shape = port.body, port.surface.shape
    axes = [body.to_world(e) - body.position for e in (shape.e_0, shape.e_1, shape.e_a)]
    center = body.to_world(shape.axis_point) - body.position
    profile = shape.profile()
    turns, slides = [axes[2]], []
    if profile.height is not None:
        return np.zeros((6, 0))
    if profile.flat:  # its normal is e_0
        turns, slides = [axes[0]], axes[1:]
    elif profile.planar:
        turns, slides = [], axes[2:]
        if profile.twist:  # a screw
            turn = profile.twist * axes[2]
            return np.concatenate([axes[2] - np.cross(turn, center), length * turn])[:, None]
    elif profile.spherical:
        turns = axes
    motions = [np.concatenate([-np.cross(turn, center), length * turn]) for turn in turns]
    motions += [np.concatenate([slide, np.zeros(3)]) for slide in slides]
    return np.array(motions).T


MOVED = 4.0  # of the deepest overlap: further than a wedge is deep, and near enough for a linear programme
NEARER = 12.0  # of it: wider gaps stay open in such a motion of both bodies and a rotation
TOUCHING = 1e-9  # of the scene's length: overlaps of surfaces that were placed in touch, by round-off
SHALLOW = 1e-7  # of the deepest overlap: residual of the linear programme
TAKES_PART = 1e-6  # of all multipliers


@dataclass(frozen=True)
class Wedge:
    """The pairs that wedge, the overlap [m] that remains at each of them, and whether a single one is held on opposite
    sides of a body."""

    contacts: tuple[Contact, ...]
    depth: float
    all_round: bool

    def __str__(self) -> str:
        names = ", ".join(repr(c.name) for c in self.contacts)
        if self.all_round:
            inner, outer = sorted((p.label for p in self.contacts[0].ports), key=lambda label: label in self._hollow)
            return (
                f"contact {names}: {inner} is too large for {outer}, an overlap of {self.depth:.3g} m on opposite "
                "sides that no motion opens; change a radius, or hold bodies that are shrunk together with joints.Fixed"
            )
        if len(self.contacts) == 1:
            ports = self.contacts[0].ports
            return (
                f"contact {names}: {ports[0].label} and {ports[1].label} overlap by {self.depth:.3g} m, and joints "
                "and drives prevent both from moving apart; move one with its joint, or use a smaller interference"
            )
        return (
            f"contacts {names}: {self._middle}, an overlap of {self.depth:.3g} m at each that no small motion opens; "
            "move the bodies apart, change a radius, or use a smaller interference"
        )

    @property
    def _hollow(self) -> list[str]:
        return [port.label for port in self.contacts[0].ports if port.surface.shape.side < 0.0]

    @property
    def _middle(self) -> str:
        """The body in the middle and its partners; of a longer chain all bodies."""
        ports = [port for contact in self.contacts for port in contact.ports]
        for body in (port.body for port in ports if not port.on_ground):
            if all(any(p.body is body for p in contact.ports) for contact in self.contacts):
                others = [port.label for port in ports if port.body is not body]
                return f"body {body.name!r} is wedged between {' and '.join(others)}"
        names = sorted({(port.body.index, port.body.name) for port in ports if not port.on_ground})
        return f"bodies {', '.join(repr(name) for _, name in names)} are wedged in a row"


def find_wedge(scene: Scene, gaps: dict[str, Nearest | None] | None = None) -> Wedge | None:
    """The deepest wedge at the initial pose, None where there is none; `gaps`: `facing_gap` of each pair by its name,
    where they are known."""
    if gaps is None:
        gaps = {contact.name: facing_gap(contact) for contact in scene.finite_sliding}
    nearest = {name: near for name, near in gaps.items() if near is not None}
    deepest, length = -min((near[0] for near in nearest.values()), default=0.0), scene_length(scene)
    if deepest <= TOUCHING * length:
        return None
    pairs = [contact for contact in scene.finite_sliding if contact.name in nearest]
    samples = [gap_samples(contact, nearest[contact.name]).below(NEARER * deepest) for contact in pairs]
    gradients = np.vstack([
        _gradients(contact, sample, len(scene.bodies), length) for contact, sample in zip(pairs, samples, strict=True)
    ])  # fmt: skip
    held = held_motions(scene)
    size = gradients.shape[1]
    answer = linprog(
        np.append(np.zeros(size), -1.0),
        A_ub=np.hstack([-gradients, np.ones((len(gradients), 1))]),
        b_ub=np.concatenate([sample.gap for sample in samples]) / deepest,
        A_eq=np.hstack([held, np.zeros((len(held), 1))]),
        b_eq=np.zeros(len(held)),
        bounds=[(-MOVED, MOVED)] * size + [(None, None)],
    )
    if not answer.success or answer.x[-1] > -SHALLOW:
        return None
    pulls = np.abs(answer.ineqlin.marginals)
    pushed = np.split(pulls > TAKES_PART * pulls.sum(), np.cumsum([len(sample.gap) for sample in samples])[:-1])
    found = [(c, sample.normal[at]) for c, sample, at in zip(pairs, samples, pushed, strict=True) if np.any(at)]
    normals = found[0][1]
    opposite = len(found) == 1 and bool(np.any(normals @ normals.T < 0.0))
    return Wedge(tuple(contact for contact, _ in found), -float(answer.x[-1]) * deepest, opposite)


def _gradients(contact: Contact, sample: GapSamples, bodies: int, length: float) -> np.ndarray:
    """Of the gaps, by translations and rotations, the latter scaled by `length` [m] (points, 6 bodies)."""
    lines = np.zeros((len(sample.gap), 6 * bodies))
    for sign, port in ((1.0, contact.a), (-1.0, contact.b)):
        if not port.on_ground:
            at = 6 * port.body.index
            arm = np.cross(sample.place - port.body.position, sample.normal) / length
            lines[:, at : at + 6] += sign * np.hstack([sample.normal, arm])
    return lines
