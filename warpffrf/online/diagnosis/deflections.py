r"""How far bodies deflected in a run, and what of that their equations leave out.

Of bodies that loads stiffen a line says, as far as they have it:

* the membrane energy V4 over the energy V2 = |z|^2/2 of the modes, z_i = omega_i q_i, the largest of the run: of zero
  the body bends without stretching, at a third a plate deflects by its thickness, about. Modes that have none are
  named, with their part of V2; where V4 exceeds `STRETCHED` times V2, too, an equilibrium may be on another branch
  than the one that a load leads to which grows slowly;
* the largest angle by which an interface turns from the mean axes. Theta is the second term of a series in such angles,
  the next is a sixth of their cube beside them: above `TURNED` that is 1.5 %, and several bodies in a row are better;
* the kinetic energy of second-order motion, which is neglected: the largest of the run over the largest of |qd|^2/2
  (`warpffrf.model.reduced.second_order_motion`). Of a body that turns, its part in the moment of inertia is neglected,
  too.

Of others a line comes where it is needed: where interfaces turn far, where a body deflects by `THICK` of its smallest
extent, that of the box with its mass and inertia (a clamped plate is then softer than it should be by a tenth and more,
a beam that may shorten by nothing), and where pictures, contact surfaces or laps lack what interfaces do of second
order. And of all bodies where the skin is strained above `STRAINED` (`warpffrf.model.reduced.skin_strain`): the
material of a body is St. Venant-Kirchhoff's, linear in the strains of Green, of which those of a metal or of rubber
differ by about the strain itself.

Skins are looked at in few of the saved steps: where the modes have most energy, and where each of the `LEADING` modes
with most of it has its largest part. Deflections, strains and angles are by the global modes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from warpffrf.model.bodies import Body
from warpffrf.model.reduced.interface_motion import interface_motion, second_order
from warpffrf.model.reduced.membrane import membrane_energies, membrane_forms
from warpffrf.model.reduced.second_order_motion import motion_of, skin_displacement
from warpffrf.model.reduced.skin_strain import skin_strain
from warpffrf.model.scene import Scene
from warpffrf.online.diagnosis.indicator import FLAG, MOST_STEPS, percent
from warpffrf.online.history.history import BodyHistory

TURNED = 0.3  # rad, see the module docstring
THICK = 0.5  # of the smallest extent
STRETCHED = 1.0  # V4/V2, about where a plate deflects by 1.7 of its thickness: most of its stiffness is of stretching
STILL = 1e-3  # rad: interfaces that turn by less do not turn
STRAINED = 0.01  # what follows of forces and stresses is wanted to 1 %
LEADING = 4  # modes

Array = np.ndarray


@dataclass(frozen=True)
class Deflection:
    """How far one `body` deflected: `membrane` largest V4/V2, `bare` largest part of V2 in modes without membrane
    energy, `turned` [rad] largest angle of an interface, its name `interface`, `inertia` kinetic energy of second-order
    motion over that of the modes, each None or zero where there is none of it; `extents` largest deflection of the skin
    over the smallest extent, `strain` largest of the skin, `place` (3,) [m, user frame] of it, `second` largest
    second-order motion of the skin, or of interfaces where the body has none of the skin, over the deflection."""

    body: str
    membrane: float | None
    bare: float
    turned: float | None
    interface: str
    inertia: float | None
    extents: float
    strain: float
    place: Array
    second: float


def deflections(scene: Scene, bodies: Mapping[str, BodyHistory]) -> list[Deflection]:
    """Of all flexible bodies of `scene` that deflected at all."""
    found = []
    for body in scene.bodies:
        q = bodies[body.name].modal
        if body.reduced is not None and q.size and np.any(q):
            steps = np.unique(np.linspace(0, len(q) - 1, MOST_STEPS).astype(int))
            found.append(_deflection(body, q[steps], np.nan_to_num(bodies[body.name].modal_velocity[steps])))
    return found


def _deflection(body: Body, q: Array, qd: Array) -> Deflection:
    reduced = body.flexible
    share = 0.5 * (2.0 * np.pi * reduced.frequencies * q) ** 2
    V2 = share.sum(axis=1)
    forms, motion = membrane_forms(body), motion_of(body)
    membrane, bare = None, 0.0
    if forms is not None and len(forms):
        rest = share[:, _stretching(forms) :].sum(axis=1)
        bare = float(np.max(rest / np.where(V2 > 0.0, V2, np.inf)))
        membrane = float(np.max(membrane_energies(forms, q) / np.where(V2 > 0.0, V2, np.inf)))
    moving = 0.5 * np.max(np.sum(qd**2, axis=1))
    inertia = None
    if motion is not None and moving > 0.0:
        inertia = float(np.abs(motion.kinetic_energy(q, qd)).max() / moving)
    turned = {n: float(np.linalg.norm(interface_motion(body, n, q)[:, 3:], axis=1).max()) for n in reduced.interfaces}
    furthest = max(turned, key=turned.__getitem__, default="")
    leading = np.argsort(share.max(axis=0))[-LEADING:]
    largest, extreme, place, second = 0.0, 0.0, np.zeros(3), 0.0
    for i in np.unique([V2.argmax(), *share[:, leading].argmax(axis=0)]):
        u = skin_displacement(body, q[i])
        largest = max(largest, _longest(u))
        if motion is not None:
            second = max(second, _longest(u - np.tensordot(q[i], reduced.surface.modes, 1)))
        strain = np.abs(skin_strain(body, q[i])).max(axis=1, initial=0.0)
        if strain.size and strain.max() > extreme:
            extreme = float(strain.max())
            place = reduced.surface.points[reduced.surface.triangles[strain.argmax()]].mean(axis=0)
    if motion is None and body.stiffening:
        second = max((_longest(0.5 * second_order(body, n, q, q)[:, :3]) for n in reduced.interfaces), default=0.0)
    return Deflection(
        body.name, membrane, bare, turned.get(furthest), furthest, inertia, largest / _smallest_extent(body), extreme,
        place, second / largest if largest > 0.0 else 0.0,
    )  # fmt: skip


def _stretching(forms: Array) -> int:
    """How many modes, the lowest, have membrane energy."""
    return int(np.flatnonzero(np.any(forms != 0.0, axis=(0, 2))).max(initial=-1)) + 1


def _longest(u: Array) -> float:
    """Largest norm of the rows of (n, 3)."""
    return float(np.linalg.norm(u, axis=1).max(initial=0.0))


def _smallest_extent(body: Body) -> float:
    """The smallest edge [m] of the box with the mass and inertia of `body`: of edges a, b, c the inertia about c is
    m (a^2 + b^2)/12."""
    J = np.linalg.eigvalsh(body.inertia)
    return float(np.sqrt(6.0 * max(J[0] + J[1] - J[2], np.finfo(float).eps * J[2]) / body.mass))


def deflection_lines(scene: Scene, found: list[Deflection], *, at_rest: bool = False) -> list[str]:
    """What the report says of them, and the cures; `at_rest`: of an equilibrium."""
    touched = {port.body.name for item in (*scene.contacts, *scene.films, *scene.laps) for port in item.ports}
    return [line for one in found for line in _lines(scene.body(one.body), one, one.body in touched, at_rest)]


def _lines(body: Body, one: Deflection, touched: bool, at_rest: bool) -> list[str]:
    name, facts, lines = f"body {one.body!r}", [], []
    far = one.turned is not None and one.turned > TURNED
    if one.membrane is not None:
        facts.append(f"membrane energy up to {percent(one.membrane)} of the energy of its modes")
    if one.turned is not None and (far or body.stiffening and one.turned > STILL):
        facts.append(f"interface {one.interface!r} turns by up to {one.turned:.2g} rad from the mean axes")
    if one.inertia is not None:
        facts.append(
            f"inertia of second-order motion, which is neglected, up to {percent(one.inertia)} of the kinetic energy "
            "of its modes"
        )
    if facts:
        cure = f"; above {TURNED:g} rad: split it into several bodies" if far else ""
        lines.append(f"{name}: {', '.join(facts)}{cure}")
    forms = membrane_forms(body)
    if one.membrane is not None and one.membrane > FLAG and forms is not None:
        first, count = _stretching(forms), body.mode_count
        if first < count:
            line = (
                f"{name}: of its {count} modes those after the first {first} have no membrane energy, and up to "
                f"{percent(one.bare)} of the energy of all; where it deflects by several thicknesses they are too soft"
            )
            if at_rest and one.membrane > STRETCHED:
                line += ", and the equilibrium may be on another branch than the one that a growing load leads to"
            lines.append(f"{line}; reduce it with membrane_modes={count}, to see")
    if not body.stiffening and one.extents > THICK:
        lines.append(
            f"{name}: it deflects by up to {one.extents:.2g} of its smallest extent, and what that stretches is left "
            f"out; if it is held against shortening, or bends both ways, use {_cure(body)}"
        )
    if one.second > FLAG and motion_of(body) is None:
        lines.append(
            f"{name}: its interfaces move by up to {percent(one.second)} of the deflection in a way of second order "
            "that pictures of it lack; use stiffening='membrane' in reduce"
        )
    if one.second > FLAG and touched:
        lines.append(
            f"{name}: its contact surfaces and laps move by its modes alone, without the second-order motion, which is "
            f"up to {percent(one.second)} of the deflection; split it into several bodies"
        )
    if one.strain > STRAINED:
        place = ", ".join(f"{x:.4g}" for x in one.place)
        lines.append(
            f"{name}: strains up to {percent(one.strain)} at ({place}) m of its skin; above {percent(STRAINED)} its "
            "material, linear in them, and stresses are wrong by about as much; load it less, make it stiffer, or take "
            "a program with materials for large strains"
        )
    return lines


def _cure(body: Body) -> str:
    known = body.flexible.inertia_terms
    has = known is not None and known.stiffening is not None and known.stiffening.membrane is not None
    return "stiffening=True in add_body" if has else "stiffening='membrane' in reduce and stiffening=True in add_body"
