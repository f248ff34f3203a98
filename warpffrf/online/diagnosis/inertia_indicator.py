r"""Indicator of the inertia terms that a run would have needed.

After a run the three terms that couple rotation and deformation (`warpffrf.model.reduced.inertia`) are evaluated on
the computed motion, whether the run kept them or not. With f_i the force of a term on mode i, dL its part of the
angular momentum, body axes

    centrifugal         f_i = w.J1_i w/2                          dL = sum_i q_i J1_i w
    deformed inertia    f_i = sum_j (w.J2_ij w) q_j               dL = sum_ij q_i q_j J2_ij w
    gyroscopic          f_j = -2 w.g'_j - wdot.g_j                dL = sum_ij q_i qdot_j G_ij,   g_j = sum_i q_i G_ij

    size = max( max_t |f_i/omega_i| / max_t |omega_i q_i| ,  max_t |dL| / max(max_t |J0 w|, l max_t |qdot|) ).

The first is the quasi-static deformation by the term's force compared with the deformation of the body, both as the
root of strain energy. The second is the change of the angular momentum by the deformation, compared with that of the
rotation, or of the vibration of a body that does not rotate, l = root(tr J0/2): for a body at rest both are noise, and
the change by noise is of second order in it. A body that does not deform at all while a term would deform it has an
infinite size: its whole deformation is omitted.

The centrifugal load does not depend on the deformation, so that any load is large compared with none: where it would
deform the body by less than NOTICEABLE of its size (|f_i/omega_i^2| over root(tr J0/2), as in `inertia_plan`) it
counts as none. The other two are proportional to the deformation, and their sizes do not depend on it.

These are estimates of first order: the effect of a neglected term is estimated on a motion without it, and only in
the modes of the body. The part of the static response to rotation outside these modes is known from the reduction, a
displacement of at most |w|^2 left_out of the size (`offline.inertia.centrifugal`); the report states it where it is
above NOTICEABLE and above FLAG of the deformation. Geometric stiffening by rotation is of the order of the deformed
inertia, w^2/omega^2, and of the opposite sign: where the one counts the other must not be omitted, and the report
states this. For one mode and a constant rotation about an axis they are

    w^2 |J1|/(2 omega^2 |q|),   w^2 J2/omega^2,   2 w G/omega (in the modes that G couples): of order 2, 2, and 1 in w.

Deflections. How far bodies deflected in a run, and the part of it that their equations neglect.

For bodies that loads stiffen, the report states, where they apply:

* the membrane energy V4 over the energy V2 = |z|^2/2 of the modes, z_i = omega_i q_i, the largest of the run: at zero
  the body bends without stretching, at a third a plate deflects by about its thickness. Modes without membrane energy
  are named, with their part of V2; where V4 also exceeds `STRETCHED` times V2, an equilibrium may be on another branch
  than the one that a slowly growing load leads to;
* the largest angle by which an interface rotates from the mean axes. Theta is the second term of a series in such
  angles, the next is a sixth of their cube: above `TURNED` that is 1.5 %, and several bodies in a row are better;
* the kinetic energy of second-order motion, which is neglected: the largest of the run over the largest of |qd|^2/2
  (`warpffrf.model.reduced.inertia`). For a body that rotates, its part in the moment of inertia is neglected, too.

For other bodies a line is added only where interfaces rotate far, where a body deflects by `THICK` of its smallest
extent, that of the box with its mass and inertia (a clamped plate is then too soft by a tenth and more, a beam free to
shorten not at all), and where pictures, contact surfaces or small-sliding contacts lack second-order motion of
interfaces. And for all bodies where the skin is strained above `STRAINED` (`warpffrf.model.reduced.stress_field`): the
material of a body is St. Venant-Kirchhoff's, linear in Green's strains, from which that of a metal or of rubber
differs by about the strain itself.

Skins are evaluated in few of the saved steps: where the modes have most energy, and where each of the `LEADING` modes
with most of it has its largest part. Deflections, strains and angles are by the global modes.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from warpffrf.model.bodies import Body
from warpffrf.model.reduced.inertia import (
    LEVELS,
    TERM_NAMES,
    InertiaTerms,
    interface_motion,
    membrane_energies,
    membrane_forms,
    motion_of,
    second_order,
    skin_displacement,
)
from warpffrf.model.reduced.stress_field import skin_strain
from warpffrf.model.scene import Scene
from warpffrf.online.compile.inertia_plan import NOTICEABLE, least_level
from warpffrf.online.history.history import BodyHistory

FLAG = 0.01  # a term above 1 % of what is kept is worth its cost: the usual accuracy of forces and displacements
SMALLEST = 1e-3  # %: smaller sizes are not reported
MOST_STEPS = 256  # saved steps evaluated, spread over the run: the sums cost (modes)^2 each

Array = np.ndarray


@dataclass(frozen=True)
class TermSize:
    """Size of a `term` (of TERM_NAMES) on a `body`, a fraction of the run's result: `on_modes` of the deformation,
    `on_momentum` of the angular momentum; whether the run `kept` the term.
    """

    body: str
    term: str
    on_modes: float
    on_momentum: float
    kept: bool

    @property
    def size(self) -> float:
        """The larger of both."""
        return max(self.on_modes, self.on_momentum)


def term_sizes(scene: Scene, bodies: Mapping[str, BodyHistory], levels: Mapping[str, str]) -> list[TermSize]:
    """Sizes of all terms on all flexible bodies of `scene` that have inertia terms; `levels` body -> level in use."""
    found = []
    for body in scene.bodies:
        reduced = body.reduced
        terms = None if reduced is None else reduced.inertia_terms
        if reduced is None or terms is None or not terms.modes:
            continue
        motion = bodies[body.name]
        if not len(motion.rotation):
            continue
        steps = np.unique(np.linspace(0, len(motion.rotation) - 1, MOST_STEPS).astype(int))
        p = motion.rotation[steps]
        w = _to_body(p, motion.angular_velocity[steps])
        w_rate = _to_body(p, np.nan_to_num(motion.angular_acceleration[steps]))  # NaN: not recorded
        q, qd = motion.modal[steps], np.nan_to_num(motion.modal_velocity[steps])
        omega = 2.0 * np.pi * np.asarray(reduced.frequencies)
        size = np.sqrt(0.5 * np.trace(body.inertia))
        strain, momentum = _largest(omega * q), max(_largest(w @ body.inertia), size * _largest(qd))
        k = terms.modes
        forces, parts = _terms(terms, q[:, :k], qd[:, :k], w, w_rate)
        bent = [_largest(f / omega[:k]) for f in forces]
        if _largest(forces[0] / omega[:k] ** 2) < NOTICEABLE * size:
            bent[0] = 0.0
        for i, name in enumerate(TERM_NAMES):
            kept = bool(LEVELS[levels[body.name]][i])
            found.append(TermSize(body.name, name, _ratio(bent[i], strain), _ratio(_largest(parts[i]), momentum), kept))
    return found


def _to_body(p: Array, x: Array) -> Array:
    """World vectors (T, 3) in the axes of a body rotated by the unit quaternions p = (u, s) (T, 4), A^T x = x - 2 s (u
    x x) + 2 u x (u x x).
    """
    u, s = p[:, :3], p[:, 3:]
    c = np.cross(u, x)
    return x - 2.0 * s * c + 2.0 * np.cross(u, c)


def _terms(terms: InertiaTerms, q: Array, qd: Array, w: Array, w_rate: Array) -> tuple[list[Array], list[Array]]:
    """Forces (T, k) and angular momenta (T, 3) of the three terms."""
    J1w = np.einsum("iab,tb->tia", terms.first, w)
    J2qw = np.einsum("tiab,tb->tia", np.tensordot(q, terms.second, 1), w)  # J2 is symmetric in its modes
    g, g1 = np.tensordot(q, terms.gyroscopic, 1), np.tensordot(qd, terms.gyroscopic, 1)
    forces = [
        0.5 * np.einsum("tia,ta->ti", J1w, w),
        np.einsum("tia,ta->ti", J2qw, w),
        -2.0 * np.einsum("tja,ta->tj", g1, w) - np.einsum("tja,ta->tj", g, w_rate),
    ]
    parts = [np.einsum("ti,tia->ta", q, J1w), np.einsum("ti,tia->ta", q, J2qw), np.einsum("tj,tja->ta", qd, g)]
    return forces, parts


def _largest(vectors: Array) -> float:
    """Largest norm of the rows of (T, n)."""
    return float(np.linalg.norm(vectors, axis=1).max())


def _ratio(size: float, kept: float) -> float:
    if size == 0.0:
        return 0.0
    return size / kept if kept > 0.0 else np.inf


def recommended(sizes: Sequence[TermSize]) -> str:
    """The least level that keeps every term of one body above FLAG."""
    return least_level([any(s.size > FLAG for s in sizes if s.term == name) for name in TERM_NAMES])


def indicator_lines(sizes: Sequence[TermSize], levels: Mapping[str, str], stiffened: Collection[str] = ()) -> list[str]:
    """Lines of the report: per body the neglected terms with their sizes, the level to use, and whether geometric
    stiffening is missing; `stiffened`: bodies that have it.
    """
    lines = []
    for body in dict.fromkeys(s.body for s in sizes):
        own = [s for s in sizes if s.body == body]
        level, better = levels[body], recommended(own)
        left_out = ", ".join(f"{s.term} {percent(s.size)}" for s in own if not s.kept)
        line = f"body {body!r}: inertia {level!r}"
        line += f", neglected of the forces kept: {left_out}" if left_out else ", nothing neglected"
        if any(not s.kept and s.size > FLAG for s in own):
            line += f"; use inertia={better!r}"
        elif better != level:
            line += f"; {better!r} is sufficient"
        softened = next((s.on_modes for s in own if s.term == "deformed inertia"), 0.0)
        if softened > FLAG and body not in stiffened:
            line += "; rotation stiffens as much as that softens: "
            line += "ReductionOptions(stiffening=True) in reduce, stiffening=True in add_body"
        lines.append(line)
    return lines


def unheld_lines(scene: Scene, bodies: Mapping[str, BodyHistory]) -> list[str]:
    """Lines of the report on bodies whose modes do not represent the static response to rotation, and the cure."""
    lines = []
    for body in scene.bodies:
        known = {} if body.reduced is None else body.reduced.report.get("inertia", {})
        motion = bodies[body.name]
        if not known.get("centrifugal_left_out") or not len(motion.angular_velocity):
            continue
        speed = _largest(motion.angular_velocity)
        missing = speed**2 * known["centrifugal_left_out"]
        found = _largest(motion.modal) / np.sqrt(0.5 * np.trace(body.inertia))
        if missing > max(NOTICEABLE, FLAG * found):
            cure = "a larger inertia_modes" if known.get("centrifugal") else "ReductionOptions(centrifugal=True)"
            lines.append(
                f"body {body.name!r}: rotation at {speed:.3g} rad/s deforms it by up to {missing:.1e} of its size in "
                f"shapes outside its modes with inertia terms; reduce it with {cure}"
            )
    return lines


def percent(size: float) -> str:
    """A size as text: two digits, "all" where there is no reference."""
    if np.isinf(size):
        return "all"
    value = 100.0 * size
    if value < SMALLEST:
        return f"< {SMALLEST:g} %" if value > 0.0 else "0 %"
    return f"{value:.0f} %" if value >= 10.0 else f"{value:.2g} %"


TURNED = 0.3  # rad, see the module docstring
THICK = 0.5  # of the smallest extent
# V4/V2, about where a plate deflects by 1.7 of its thickness: most of its stiffness is that of stretching
STRETCHED = 1.0
STILL = 1e-3  # rad: smaller rotations of interfaces count as none
STRAINED = 0.01  # the usual accuracy of forces and stresses is 1 %
LEADING = 4  # modes


@dataclass(frozen=True)
class Deflection:
    """Largest deflection of one `body`: `membrane` largest V4/V2, `bare` largest part of V2 in modes without membrane
    energy, `turned` [rad] largest angle of an interface, its name `interface`, `inertia` kinetic energy of second-order
    motion over that of the modes, each None or zero where it does not apply; `extents` largest deflection of the skin
    over the smallest extent, `strain` largest of the skin, `place` (3,) [m, user frame] of it, `second` largest
    second-order motion of the skin, or of interfaces where the body has none of the skin, over the deflection.
    """

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
    """Deflections of all flexible bodies of `scene` that deflected."""
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
    """Number of modes, the lowest, that have membrane energy."""
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
    """Lines of the report on them, and the cures; `at_rest`: of an equilibrium."""
    touched = {port.body.name for item in (*scene.contacts, *scene.films) for port in item.ports}
    return [line for one in found for line in _lines(scene.body(one.body), one, one.body in touched, at_rest)]


def _lines(body: Body, one: Deflection, touched: bool, at_rest: bool) -> list[str]:
    name, facts, lines = f"body {one.body!r}", [], []
    far = one.turned is not None and one.turned > TURNED
    if one.membrane is not None:
        facts.append(f"membrane energy up to {percent(one.membrane)} of the energy of its modes")
    if one.turned is not None and (far or body.stiffening and one.turned > STILL):
        facts.append(f"interface {one.interface!r} rotates by up to {one.turned:.2g} rad from the mean axes")
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
            f"{name}: it deflects by up to {one.extents:.2g} of its smallest extent, and the resulting stretching is "
            f"neglected; if its shortening is constrained, or it bends in two directions, use {_cure(body)}"
        )
    if one.second > FLAG and motion_of(body) is None:
        lines.append(
            f"{name}: its interfaces move by up to {percent(one.second)} of the deflection by second-order motion "
            "that its pictures omit; use ReductionOptions(stiffening='membrane') in reduce"
        )
    if one.second > FLAG and touched:
        lines.append(
            f"{name}: its contact surfaces and joint faces move by its modes only, without the second-order motion, "
            f"which is up to {percent(one.second)} of the deflection; split it into several bodies"
        )
    if one.strain > STRAINED:
        place = ", ".join(f"{x:.4g}" for x in one.place)
        lines.append(
            f"{name}: strains up to {percent(one.strain)} at ({place}) m of its skin; above {percent(STRAINED)} its "
            "material, linear in them, and stresses are wrong by about as much; load it less, make it stiffer, or use "
            "a program with materials for large strains"
        )
    return lines


def _cure(body: Body) -> str:
    known = body.flexible.inertia_terms
    has = known is not None and known.stiffening is not None and known.stiffening.membrane is not None
    reduced = "" if has else "ReductionOptions(stiffening='membrane') in reduce and "
    return f"{reduced}stiffening=True in add_body"
