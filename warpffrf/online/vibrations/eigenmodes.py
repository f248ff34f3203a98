r"""Complex modes of a scene: the first-order form of M y'' + D y' + K y + C^T dlambda = 0, C y = 0.

Rigid rows are constraints, not stiff springs: with coordinates scaled by S = diag(M)^(-1/2) and N an orthonormal basis
of the null space of C S (singular values below RANK of the largest are no constraint), y = S N z leaves

    m z'' + d z' + k z = 0.

m is well conditioned, but k contains both the pendulum and the highest mode, and an eigenvalue of k is only as accurate
as round-off of the largest. So z is first written in the eigenvectors V of the symmetric pair (m, k + sigma m): they
are computed from the inverse k^-1, so that the low ones are accurate. There k is nearly diagonal and graded, and the
eigenvalues of

    [ 0               1            ]
    [ -m^-1 k     -m^-1 d          ]           (z, z') = phi exp(lambda t)

after balancing are as accurate as round-off of the largest *frequency*. Frequency |lambda|/2 pi, damping ratio
-Re(lambda)/|lambda|. Of a pair of conjugates the one with Im > 0 is kept; an overdamped motion has two real eigenvalues
and both are kept. Motions without stiffness have lambda = 0, one for each direction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.linalg

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError, require_count
from warpffrf.model.friction import friction_notes, rolling_notes, rubbing
from warpffrf.model.scene import Scene
from warpffrf.online.checkpoint import is_dynamic, off_end_of, restore, turned_of
from warpffrf.online.compile.inertia_plan import NOTICEABLE
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.outcome import coarser, describe
from warpffrf.online.settings import Settings
from warpffrf.online.start.consistent import start_consistently
from warpffrf.online.start.static_equilibrium import settle
from warpffrf.online.vibrations.film_modes import film_modes
from warpffrf.online.vibrations.linearise import Linearisation, linearise
from warpffrf.online.vibrations.quadratic import quadratic_modes
from warpffrf.online.vibrations.stuck_contacts import stuck_notes
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf_kernels.core.control import LOADING, STATIC

Array = np.ndarray
RANK = 1e-10  # of the largest singular value: rows that constrain nothing; the compiler has removed dependent rows
ZERO = 2.0 * np.pi * 1e-4  # rad/s: a period of three hours; differences of kernels do not resolve a lower stiffness
SHIFT = 1.0  # 1/s2: makes k + sigma m definite for unconstrained bodies
MORE_SHIFT = 10.0  # factor, where an unstable state needs a larger one
MOST_SHIFTS = 30
SAME_SHAPE = 1e-6  # singular value, below which the shapes of two zero eigenvalues are one motion
REAL = 1e-7  # of |lambda|: a smaller imaginary part is round-off of a double real eigenvalue
LOST = (
    "oil films: the search for {} heavily damped motions came to nothing, as voids travel no faster than they would "
    "die out; the slowest of them was looked for at {:.4g} 1/s"
)
Solve = Callable[[Array, Array, Array, Array], tuple[Array, Array]]
STEADY = 1e-3  # of weight and centripetal acceleration: above it the state is transient
SHAKES = (
    1e-2  # of the centripetal acceleration within a body, where flexible ones begin to stretch in their stiff modes
)


@dataclass(frozen=True, eq=False)
class BodyShape:
    """A mode on one body: `translation` (3,) of its user origin [m] and `rotation` (3,) [rad], world axes, and `modal`
    (m,), all complex: the motion is the real part of shape * exp(lambda t)."""

    translation: Array
    rotation: Array
    modal: Array


@dataclass(frozen=True, eq=False)
class SceneModes:
    """Modes by rising frequency: `eigenvalues` (n,) complex [1/s], `shapes` body -> (n,) list of BodyShape.

    Shapes are scaled to y^H M y = 1 kg m2 with the largest coordinate real, `scene` and `time` [s] define the state,
    `method` how it was found, `notes` what was omitted.
    """

    scene: Scene
    about: str
    time: float
    eigenvalues: Array
    shapes: dict[str, list[BodyShape]]
    position: dict[str, Array]  # of the user origins in that state, world [m]
    rotation: dict[str, Array]  # quaternions (x, y, z, w)
    modal: dict[str, Array]
    shares: dict[str, Array]  # body -> (n,) part of the kinetic energy
    linear: Linearisation
    vectors: Array  # (y, n) shapes over the coordinates of `linear`
    state: dict[str, Array]  # of the device, a checkpoint
    device: str | None = None
    settings: Settings | None = None
    notes: list[str] = field(default_factory=list)


@WARP_LOCK
def find_modes(
    scene: Scene,
    count: int = 20,
    *,
    about: History | str | None = None,
    device: str | None = None,
    settings: Settings | None = None,
    progress: bool = False,
) -> SceneModes:
    """The `count` modes of lowest frequency of `scene` about a state.

    about: None for its equilibrium, "initial" for its initial positions and velocities, or the History of a run of this
    scene, whose last state is meant, velocities included. Raises InputError for wrong input and for a state that cannot
    be found.
    """
    count = require_count(count, "eigenmodes: count", 1)
    turned = turned_of(about.checkpoint, scene) if isinstance(about, History) else ()
    off_end = isinstance(about, History) and off_end_of(about.checkpoint)
    engine = Engine(scene, device=device, settings=settings, turned=turned, off_end=off_end, progress=progress)
    notes: list[str] = []
    name = _prepare(engine, about, notes)
    linear = linearise(engine)
    notes.extend(_notes(engine, linear, name))

    def with_films(m: Array, d: Array, k: Array, basis: Array) -> tuple[Array, Array]:
        lam, phi, lost = film_modes(m, d, k, linear.T @ basis, linear.U @ basis, linear.films, count)
        if lost:
            notes.append(LOST.format(len(lost), max(value.real for value in lost)))
        return lam, phi

    values, vectors = complex_modes(
        linear.M, linear.D, linear.K, linear.C, max(ZERO, linear.resolution), with_films if linear.films else None
    )
    values, vectors = values[:count], vectors[:, :count]
    return _wrapped(engine, name, values, vectors, linear, notes)


def complex_modes(
    M: Array, D: Array, K: Array, C: Array, zero: float = ZERO, solve: Solve | None = None
) -> tuple[Array, Array]:
    """Eigenvalues (n,) [1/s] by rising modulus and shapes (coordinates, n) of M y'' + D y' + K y = 0 with C y = 0;
    solve: solver of (m, d, k, basis) that replaces m z'' + d z' + k z, y = basis z, for scenes with films.

    Those below `zero` [1/s] are motions without stiffness, one for each direction. Raises InputError where a free
    coordinate has no mass.
    """
    S = 1.0 / np.sqrt(np.abs(np.diag(M)))
    basis = free_basis(M, K, C)
    if not basis.shape[1]:
        return np.zeros(0, complex), np.zeros((len(M), 0), complex)
    m, d, k = (basis.T @ X @ basis for X in (M, D, K))
    lam, phi = solve(m, d, k, basis) if solve is not None else quadratic_modes(m, d, k)
    Y = basis @ phi
    still = np.abs(lam) < zero
    Y_still = (
        _independent(np.concatenate([np.real(Y[:, still]), np.imag(Y[:, still])], axis=1) / S[:, None]) * S[:, None]
    )
    kept = ~still & (np.imag(lam) >= -REAL * np.abs(lam))
    real = kept & (np.abs(np.imag(lam)) <= REAL * np.abs(lam))
    lam[real] = np.real(lam[real])
    lam = np.concatenate([np.zeros(Y_still.shape[1]), lam[kept]])
    Y = np.concatenate([Y_still, Y[:, kept]], axis=1)
    order = np.lexsort((np.real(lam), np.abs(lam)))
    return lam[order], _scaled(Y[:, order], M)


def free_basis(M: Array, K: Array, C: Array) -> Array:
    """Basis (n, free) of the y that the rigid rows C leave: eigenvectors of M y'' + K y, M-orthonormal, stiffest first.

    Raises InputError where a free coordinate has no mass.
    """
    S = 1.0 / np.sqrt(np.abs(np.diag(M)))
    N = S[:, None] * null_space(C * S)
    return N @ _graded_basis(N.T @ M @ N, N.T @ K @ N) if N.shape[1] else N


def null_space(C: Array) -> Array:
    """Orthonormal basis (n, free) of the directions that rows C (rows, n) leave free."""
    if not len(C):
        return np.eye(C.shape[1])
    length = np.linalg.norm(C, axis=1, keepdims=True)
    _, s, Vt = np.linalg.svd(C / np.where(length > 0.0, length, 1.0))
    rank = int(np.sum(s > RANK * max(s[0], np.finfo(float).tiny)))
    return Vt[rank:].T


def _graded_basis(m: Array, k: Array) -> Array:
    """Eigenvectors of the symmetric parts of (m, k + sigma m), m-orthonormal, stiffest first."""
    m, k = 0.5 * (m + m.T), 0.5 * (k + k.T)
    sigma = SHIFT
    for _ in range(MOST_SHIFTS):
        try:
            mu, V = scipy.linalg.eigh(m, k + sigma * m)
        except np.linalg.LinAlgError:
            sigma *= MORE_SHIFT
            continue
        if mu[0] > 0.0:
            return V / np.sqrt(np.einsum("in,ij,jn->n", V, m, V))
        break
    raise InputError("eigenmodes: a body or mode that can move has no mass; check masses and inertia tensors")


def _independent(vectors: Array) -> Array:
    """Orthonormal basis of the span of columns of equal importance, but for those of round-off."""
    length = np.linalg.norm(vectors, axis=0)
    counts = length > SAME_SHAPE * np.max(length, initial=0.0)
    vectors = vectors[:, counts] / length[counts]
    if not vectors.shape[1]:
        return vectors
    U, s, _ = np.linalg.svd(vectors, full_matrices=False)
    return U[:, s > SAME_SHAPE * s[0]]


def _scaled(Y: Array, M: Array) -> Array:
    """Columns with y^H M y = 1 whose largest coordinate, weighed by its mass, is real and positive."""
    if not Y.shape[1]:
        return Y.astype(complex)
    mass = np.real(np.einsum("in,ij,jn->n", Y.conj(), M, Y))
    at = np.argmax(np.abs(Y) * np.sqrt(np.abs(np.diag(M)))[:, None], axis=0)
    largest = Y[at, np.arange(Y.shape[1])]
    return Y * (np.abs(largest) / (largest * np.sqrt(mass)))


def _prepare(engine: Engine, about: Any, notes: list[str]) -> str:
    """Set the engine to the state `about`; returns its description."""
    if about is None:
        if not settle(engine):
            bits = int(engine.word("status")[0])
            why = (
                describe(bits, int(engine.word("spare")[0]), coarser(engine))[1]
                if bits
                else "a body does not come to rest"
            )
            raise InputError(
                f"eigenmodes: no equilibrium was found ({why}); add a spring, joint or contact that carries the load, "
                "or use about='initial', or the Result of a run"
            )
        notes.extend(engine.start_notes)
        return "equilibrium"
    if isinstance(about, str) and about == "initial":
        engine.initial_rates()
        start_consistently(engine)
        notes.extend(engine.start_notes)
        if np.any(engine.word("status")):
            why = describe(int(engine.word("status")[0]), int(engine.word("spare")[0]))[1]
            raise InputError(f"eigenmodes: the initial state is not consistent ({why})")
        return "initial state"
    if isinstance(about, History):
        state = about.checkpoint
        if state and ("v_rate" not in state or np.shape(state["q"]) != tuple(engine.state.q.shape)):
            raise InputError(
                "eigenmodes: the state of the result cannot be linearised; it must come from a run with "
                "local_modes='quasi_static' and one of the integrators with coefficients "
                "(GeneralizedAlpha, HHT, Newmark), or from an equilibrium"
            )
        words = state.get("clk") if state else None
        restore(engine, state, 1.0 if words is None else float(words["user_step"][0]), "eigenmodes: about")
        return "last state of a run" if is_dynamic(about.checkpoint) else "equilibrium of a result"
    raise InputError(
        f"eigenmodes: about must be None (equilibrium), 'initial', or a Result of this scene, got {about!r}"
    )


def _notes(engine: Engine, linear: Linearisation, name: str) -> list[str]:
    """Notes on the modes."""
    notes = list(engine.compiled.notes) + _rubbing_notes(engine)
    if linear.lumped:
        notes.append(
            f"closed lumped contacts ({linear.lumped} places) have the stiffness of their laws at the forces they "
            "carry: the modes are those of vibrations small compared with their approaches"
        )
    if linear.closed:
        notes.append(
            f"closed contacts stay closed ({linear.closed} active nodes): the modes are those of vibrations too small "
            "to open them, with the patch held in place; what rolls it along is at 0 Hz"
        )
    notes.extend(stuck_notes(engine, name))
    if linear.films:
        notes.append(
            "oil films keep their cavities: the modes are those of vibrations too small to change them; motions "
            "of oil alone are left out, walls slide as the state has it, and at an equilibrium what drag does to small "
            "motions is left out"
        )
    if linear.kinked:
        notes.append(
            f"the characteristic of force {', '.join(map(repr, linear.kinked))} has a kink where it stands: the modes "
            "are those of its slope on the side of larger deformation and rate"
        )
    if linear.turning:
        names = ", ".join(repr(n) for n in linear.turning)
        if linear.co_rotating:
            notes.append(
                f"rotating bodies: {names}; frequencies are those in axes that rotate with each body, exact where all "
                "of them rotate as one and their supports are isotropic; else those of this instant"
            )
        else:
            notes.append(f"rotating bodies: {names}; frequencies are those in world axes")
    if name != "equilibrium" and _passing(engine):
        notes.append("the state is not steady (bodies accelerate, or stretch): the modes are those of this instant")
    return notes


def _rubbing_notes(engine: Engine) -> list[str]:
    """Notes on the treatment of friction and rolling resistance in small motions (`linearise`)."""
    scene = engine.scene
    if int(engine.word("mode")[0]) in (int(STATIC), int(LOADING)):
        return friction_notes(scene, "eigenmodes") + rolling_notes(scene, "eigenmodes")
    lumped = [contact for contact in scene.lumped_contacts if contact.friction.acts]
    held = [name for name in rubbing(scene) if name not in {contact.name for contact in lumped}]
    springs = [contact.name for contact in lumped if not contact.friction.creep_limit]
    dampers = [contact.name for contact in lumped if contact.friction.creep_limit]
    rolling = [contact.name for contact in scene.lumped_contacts if contact.rolling_resistance is not None]
    said = {
        "friction of {} keeps the forces that it has in the state, and neither holds nor damps small motions": held,
        "friction of {} holds small motions by the tangential stiffness of the patch where it sticks in the state; "
        "where it slips, along the slip by half of that, the mean of going on and turning back": springs,
        "regularised friction of {} damps small motions by its slope at the velocities of the state": dampers,
        "rolling resistance of {} damps small motions by its slope at the velocities of the state": rolling,
    }
    return [note.format(", ".join(map(repr, names))) for note, names in said.items() if names]


def _passing(engine: Engine) -> bool:
    """Whether velocities change other than by rotation with the body, or bodies deform."""
    state = engine.state
    gravity = float(np.linalg.norm(engine.scene.gravity))
    flexible = any(b.reduced is not None for b in engine.scene.bodies)
    for b in engine.scene.bodies:
        v, w = state.v.numpy()[0, b.index], state.omega.numpy()[0, b.index]
        a, wdot = state.v_rate.numpy()[0, b.index], state.omega_rate.numpy()[0, b.index]
        turned = rot.matrix(state.p.numpy()[0, b.index]) @ w
        circling = np.cross(turned, v)
        change = min(np.linalg.norm(a), np.linalg.norm(a - circling))
        within = float(w @ w) * np.sqrt(0.5 * np.trace(b.inertia) / b.mass) if flexible else 0.0
        if change > max(STEADY * max(gravity, float(np.linalg.norm(circling)), 1.0), SHAKES * within):
            return True
        if np.linalg.norm(wdot) > STEADY * max(float(w @ w), 1.0):
            return True
        if b.reduced is not None:  # deformation until its modes are at rest, relative to its size
            own = slice(int(engine.compiled.modal_start[b.index]), int(engine.compiled.modal_start[b.index + 1]))
            rates = state.qd_rate.numpy()[0, own][: b.mode_count]
            ahead = np.linalg.norm(rates / (2.0 * np.pi * b.reduced.frequencies) ** 2)
            bound = NOTICEABLE if b.stiffening else STEADY  # small strains change the stiffness of slender bodies
            if ahead > bound * np.sqrt(0.5 * np.trace(b.inertia)):
                return True
    return False


def _wrapped(
    engine: Engine, name: str, values: Array, vectors: Array, linear: Linearisation, notes: list[str]
) -> SceneModes:
    """Shapes by body, at the user origins, world axes; kinetic energy is that of the velocities y' seen in y's axes."""
    energy = np.real(vectors.conj() * (linear.M @ vectors))
    own_vectors, vectors = vectors, linear.T @ vectors
    shapes: dict[str, list[BodyShape]] = {}
    position, rotation, modal, shares = {}, {}, {}, {}
    start, B = engine.compiled.modal_start, engine.compiled.model.bodies.count
    state = engine.state.to_numpy()
    for b in engine.scene.bodies:
        A = rot.matrix(state["p"][0, b.index])
        arm = A @ b.center_of_mass
        position[b.name], rotation[b.name] = state["r"][0, b.index] - arm, state["p"][0, b.index]
        own = slice(int(start[b.index]), int(start[b.index + 1]))
        modal[b.name] = state["q"][0, own]
        both = energy[6 * b.index : 6 * b.index + 6].sum(axis=0)
        shares[b.name] = both + energy[6 * B + own.start : 6 * B + own.stop].sum(axis=0)
        rows = vectors[6 * b.index : 6 * b.index + 6]
        shapes[b.name] = []
        for i in range(len(values)):
            turn = A @ rows[3:, i]
            q = vectors[6 * B + own.start : 6 * B + own.stop, i]
            shapes[b.name].append(BodyShape(rows[:3, i] - np.cross(turn, arm), turn, q))
    time = float(engine.word("time")[0])
    return SceneModes(
        engine.scene, name, time, values, shapes, position, rotation, modal, shares, linear, own_vectors,
        engine.checkpoint(), engine.compiled.device, engine.settings, notes,
    )  # fmt: skip
