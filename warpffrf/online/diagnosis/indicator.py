r"""Which inertia terms a run would have needed: the indicator.

After a run the three terms that couple turning and deforming (`warpffrf.model.reduced.inertia`) are evaluated on the
motion that was found, kept or not. With f_i the force of a term on mode i, dL its part of the angular momentum, body
axes

    centrifugal         f_i = w.J1_i w/2                          dL = sum_i q_i J1_i w
    deformed inertia    f_i = sum_j (w.J2_ij w) q_j               dL = sum_ij q_i q_j J2_ij w
    gyroscopic          f_j = -2 w.g'_j - wdot.g_j                dL = sum_ij q_i qdot_j G_ij,   g_j = sum_i q_i G_ij

    size = max( max_t |f_i/omega_i| / max_t |omega_i q_i| ,  max_t |dL| / max(max_t |J0 w|, l max_t |qdot|) ).

The first is what the term's force would deform, quasi-statically, beside what the body did deform, both as the root of
strain energy; the second what the deformation changes of the angular momentum, beside that of the turning, or of the
vibration of a body that does not turn, l = root(tr J0/2): of a body at rest both are noise, and what noise changes is
of second order in it. A body that does not deform at all while a term would deform it has an infinite size: all of its
deformation is left out.

The centrifugal load does not depend on the deformation, so that beside none at all any load is large: where it would
deform the body by less than NOTICEABLE of its size (|f_i/omega_i^2| over root(tr J0/2), as in `inertia_plan`) it
counts as none. The other two are proportional to the deformation, and their sizes do not depend on it.

These are estimates of first order: what a neglected term would have done is judged on a motion without it, and only in
the modes that the body has. What of the static response to turning these do not hold is known from the reduction, a
displacement of at most |w|^2 left_out of the size (`offline.inertia.centrifugal`); a line says so where that is
NOTICEABLE and more than FLAG of the deformation found. Geometric stiffening by turning is of the order of the deformed
inertia, w^2/omega^2, and of the opposite sign: where the one counts the other must not be left out, and a line says so.
Over one mode and a constant turning about an axis they are

    w^2 |J1|/(2 omega^2 |q|),   w^2 J2/omega^2,   2 w G/omega (in the modes that G couples): of order 2, 2, and 1 in w.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from warpffrf.model.reduced.inertia import LEVELS, TERM_NAMES, InertiaTerms
from warpffrf.model.scene import Scene
from warpffrf.online.compile.inertia_plan import NOTICEABLE, least_level
from warpffrf.online.history.history import BodyHistory

FLAG = 0.01  # a term above 1 % of what is kept is worth its cost: forces and displacements are wanted to that
SMALLEST = 1e-3  # %: what is smaller is no news
MOST_STEPS = 256  # saved steps looked at, spread over the run: the sums cost (modes)^2 each

Array = np.ndarray


@dataclass(frozen=True)
class TermSize:
    """Size of a `term` (of TERM_NAMES) on a `body`, a fraction of what the run found: `on_modes` of the deformation,
    `on_momentum` of the angular momentum; whether the run `kept` the term."""

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
    """World vectors (T, 3) in the axes of a body turned by the unit quaternions p = (u, s) (T, 4), A^T x = x - 2 s (u x
    x) + 2 u x (u x x)."""
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
    parts = [
        np.einsum("ti,tia->ta", q, J1w),
        np.einsum("ti,tia->ta", q, J2qw),
        np.einsum("tj,tja->ta", qd, g),
    ]
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
    """What the report says: per body the neglected terms with their sizes, the level to use, and whether geometric
    stiffening is missing; `stiffened`: bodies that have it."""
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
            line += f"; {better!r} would do"
        softened = next((s.on_modes for s in own if s.term == "deformed inertia"), 0.0)
        if softened > FLAG and body not in stiffened:
            line += "; turning stiffens as much as that softens: stiffening=True in reduce and add_body"
        lines.append(line)
    return lines


def unheld_lines(scene: Scene, bodies: Mapping[str, BodyHistory]) -> list[str]:
    """What the report says of bodies whose modes do not hold what turning does to them, and the cure."""
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
            cure = "a larger inertia_modes" if known.get("centrifugal") else "centrifugal=True"
            lines.append(
                f"body {body.name!r}: turning at {speed:.3g} rad/s deforms it by up to {missing:.1e} of its size in "
                f"shapes that its modes with inertia terms do not hold; reduce it with {cure}"
            )
    return lines


def percent(size: float) -> str:
    """A size in words: two digits, "all" where there is nothing beside it."""
    if np.isinf(size):
        return "all"
    value = 100.0 * size
    if value < SMALLEST:
        return f"< {SMALLEST:g} %" if value > 0.0 else "0 %"
    return f"{value:.0f} %" if value >= 10.0 else f"{value:.2g} %"
