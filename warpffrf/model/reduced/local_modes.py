r"""Local modes of a contact surface as dynamic modes: frequencies, traces, and the compliance of the truncated modes.

Symbols: `Phi_g` global modes (M-orthonormal, K-orthogonal, frequencies `Omega_g`), `U` (n, nodes) residual static
responses to unit *nodal forces* f [m/N], all matrices in that unit:

    D = U^T K U     compliance (`ContactSurface.lags`),      Phi_g^T K U = 0 for any Phi_g (residual responses),
    N = U^T M U     mass Gram matrix  [m^2 kg/N^2],
    W = Phi_g^T M U overlap with the global modes  [m kg/N].

W is not zero: attachment modes in Phi_g are not vibration modes. Its rank is the number of attachment modes (six per
rigid interface; on periodic bodies only in the harmonics 0 and 1).

**Which subspace.** The union span{Phi_g, U} holds the exact static response. Four ways to diagonalise it were compared.
(1) Eigenmodes of the union replace the global ones: exact, but then every local mode moves the interfaces, and joints
would couple thousands of modes. (2) `U - Phi_g W` is M-orthogonal to Phi_g and K-coupled with it, by `-Omega_g^2 W`:
neglecting this makes the static response wrong. (3) All of U with W omitted from the mass matrix: a kinetic energy that
is not that of the displacement, by cosines of up to 0.8, and frequencies without a bound. (4) Local modes in

    L = {U y : W y = 0},

used here, are K-orthogonal *and* M-orthogonal to Phi_g, M-orthogonal to rigid motion, and move no interface (see
`global_basis`), all exactly. The global modes are unchanged. With `y_j` from

    N y = (1/omega^2) D y   on  W y = 0,      y_i^T N y_j = 1 if i = j, else 0

the modes `phi_j = U y_j` are M-orthonormal, K-orthogonal, and Phi_g and they make mass and stiffness diagonal together.
What is neglected is the inertia of the few directions of U (at most one per attachment mode) that are K-orthogonal to
L: they follow their load statically, within `D_rest`. The kinetic energy is that of the part that moves with inertia,
so energy and momentum are conserved, and the static response remains exact. The frequencies of Phi_g and L together are
Rayleigh-Ritz values: the k-th is at or above the k-th of the mesh, and with r directions held quasi-static at or
below the (k+r)-th of the union (Cauchy). More global modes reduce the neglected part.

They are responses to static loads, not eigenmodes: nearly exact in their inertia well below the lowest of them, 10 to
30 % high in frequency themselves. Where a motion at those frequencies matters, use more global modes.

**The online step.** With `t_j = D y_j` (`trace`, nodal coefficients of the outward normal displacement, as
`mode_normal`) a load of nodal forces f drives mode j by `t_j^T f`, because `phi_j^T B s = t_j^T M_psi s`:

    q_j'' + 2 zeta_j omega_j q_j' + omega_j^2 q_j = t_j^T f,       u_n = mode_normal q_g + trace q + D_rest f,

    D_rest = D - sum_kept t_j t_j^T / omega_j^2      (positive semidefinite).

At rest `q_j = t_j^T f/omega_j^2` and `u_n` is exact for any truncation. For a body of L equal sectors everything is
computed per harmonic; both real modes of a harmonic are kept or truncated, so that D_rest stays block-circulant.

**Displacement anywhere**: that of the modes is the response to nodal forces `y`. Dynamic modes q and forces f together
are equivalent to the nodal forces `f + y (q - Omega^-2 t^T f)` (`DynamicModes.equivalent_forces`), to be used in place
of f wherever a displacement, or the local modes' part of a stress, is recovered.

Slopes. Contact surfaces whose normals tilt under pressure: their compliance in a scene.

Pressed together, two surfaces have one common shape in the patch. The bending of each follows from its compliance: of
the relative curvature 1/R* a body takes the share s = c_A/(c_A + c_B), c = (1 - nu^2)/E (Johnson, Contact Mechanics,
section 4.2), so that its normals tilt by s x/R*, and its compliance becomes (`warpffrf.offline.contact.local_mass`)

    D + s (R/R*) S.

On a rigid plane, and between two equal rollers, s R/R* = 1: a whole patch is pressed in one direction. A pin in a
bore of its own radius has R/R* = 0. A surface in several contacts uses their mean.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.reduced.contact_surface import ContactSurface

Array = np.ndarray
# Eigenvalue of D over its largest below which a direction is too stiff to separate from round-off of D (1e-16 of the
# largest, amplified by the square of the divisor); nodes of nodal grids have 1e-6.
DEPENDENT = 1e-12
# 1/omega^2 over its largest below which a mode is assigned to D_rest: 3,000 times the lowest one, where round-off of N
# (1e-16 of the largest) reaches 1e-9 of the modal mass.
TOO_STIFF = 1e-7
# Part of a unit-energy local direction in a global mode, relative to the largest possible, above which the two
# count as coupled. Vibration modes overlap by round-off, 1e-13; attachment modes by 1e-3 and more.
COUPLED = 1e-8
SAME_FREQUENCY = 1e-6  # relative distance of frequencies that form one multiple frequency, never split


@dataclass(frozen=True, eq=False)
class DynamicModes:
    """Local modes with inertia, ascending in frequency, and the quasi-static rest (module docstring).

    `omega` (n,) [rad/s]. `trace` (columns rows, n): nodal coefficients of the outward normal displacement per unit
    modal coordinate (modal mass 1 kg); the transpose maps nodal forces [N] to modal forces. `shape` (L c rows, n) [N]:
    nodal forces whose static residual response is the mode. `residual_lags` (L, c rows, c rows) [m/N]: D_rest, layout
    of `lags`. `stiffer`: rad/s of the lowest truncated mode, inf where there is none. `held`: directions that stay
    quasi-static because their mass couples with the global modes. `dropped`: directions too stiff to resolve.
    """

    omega: Array
    trace: Array
    shape: Array
    residual_lags: Array
    stiffer: float
    held: int
    dropped: int

    def equivalent_forces(self, forces: Array, q: Array) -> Array:
        """Nodal forces (columns, rows) [N] on the full revolution, for `ContactSurface.recover`: static response of
        modal coordinates `q` (n,) and response of the rest to `forces` (columns, rows) [N]."""
        f = np.asarray(forces, dtype=np.float64)
        rows = f.shape[1]
        out = np.zeros((len(self.shape) // rows, rows))
        out[: len(f)] = f
        static = self.trace.T @ f.ravel() / self.omega**2
        return out + (self.shape @ (np.asarray(q, dtype=np.float64) - static)).reshape(-1, rows)


def dynamic_modes(
    surface: ContactSurface, *, count: int | None = None, max_frequency: float | None = None
) -> DynamicModes:
    """The local modes of `surface` with inertia: the lowest `count`, those up to `max_frequency` [Hz], or the fewer of
    both; neither: all. Multiple frequencies are never split, so that `count` may be exceeded by a few.

    Raises `InputError` for a body that was reduced without the mass of its local modes, and for bad limits.
    """
    mass = surface.local_mass
    if mass is None:
        raise InputError(
            f"contact {surface.name!r}: the reduced body does not contain the mass of its local modes; reduce it with "
            "local_dynamics=True"
        )
    if count is not None:
        count = require_count(count, "local modes: count", 0)
    highest = np.inf
    if max_frequency is not None:
        highest = 2.0 * np.pi * require_number(max_frequency, "local modes: max_frequency", positive=True)
    L, size = surface.lags.shape[:2]
    D = _harmonics(surface.lags)
    N = _harmonics(mass.lags_mass)
    W = np.conj(np.fft.rfft(mass.overlap.reshape(L, size, -1), axis=0)) / np.sqrt(L)
    blocks = _modes(D, N, W, L)
    omega, ends = _kept(blocks, L, count, highest)

    traces, shapes = [], []
    for k, (block, end) in enumerate(zip(blocks, ends, strict=True)):
        t = block.trace[:, :end]
        D[k] -= (t / block.omega[:end] ** 2) @ t.conj().T
        traces.append(_real(t, k, L))
        shapes.append(_real(block.shape[:, :end], k, L))
    left = [b.omega[end] for b, end in zip(blocks, ends, strict=True) if end < len(b.omega)]
    weight = [_multiplicity(k, L) for k in range(len(blocks))]
    order = np.argsort(omega, kind="stable")
    return DynamicModes(
        omega=omega[order],
        trace=np.concatenate(traces, axis=1)[: surface.local_modes, order],
        shape=np.concatenate(shapes, axis=1)[:, order],
        residual_lags=np.ascontiguousarray(np.fft.irfft(D, n=L, axis=0)),
        stiffer=float(min(left, default=np.inf)),
        held=sum(w * b.held for w, b in zip(weight, blocks, strict=True)),
        dropped=sum(w * b.dropped for w, b in zip(weight, blocks, strict=True)),
    )


@dataclass
class _Block:
    """Modes of one harmonic: omega (p,) ascending, trace and shape (size, p), and the omitted directions."""

    omega: Array
    trace: Array
    shape: Array
    held: int
    dropped: int


def _harmonics(lags: Array) -> Array:
    """Hermitian blocks (L//2 + 1, size, size) of the harmonics of a block-circulant matrix."""
    blocks = np.fft.rfft(lags, axis=0)
    return 0.5 * (blocks + blocks.conj().transpose(0, 2, 1))


def _multiplicity(k: int, L: int) -> int:
    """Real modes for one mode of harmonic k."""
    return 1 if k == 0 or 2 * k == L else 2


def _modes(D: Array, N: Array, W: Array, L: int) -> list[_Block]:
    """Modes of every harmonic; W (harmonics, size, m)."""
    parts = []
    for k in range(len(D)):
        single = _multiplicity(k, L) == 1
        parts.append(np.linalg.eigh(D[k].real if single else D[k]))
    floor = DEPENDENT * max(float(d[-1]) for d, _ in parts)
    reduced = []
    for k, (d, V) in enumerate(parts):
        keep = d > floor
        d, V = d[keep], V[:, keep]
        real = not np.iscomplexobj(V)
        S = V / np.sqrt(d)
        A = S.conj().T @ (N[k].real if real else N[k]) @ S
        G = (W[k].real if real else W[k]).T @ S
        reduced.append((d, V, 0.5 * (A + A.conj().T), G))
    largest = max(float(np.linalg.norm(A)) for *_, A, _ in reduced)  # bounds each 1/omega^2 of its harmonic
    blocks = []
    for d, V, A, G in reduced:
        held = _coupled(G, COUPLED * np.sqrt(largest))
        if held.shape[1]:
            A = A - held @ (held.conj().T @ A)
            A = A - (A @ held) @ held.conj().T
            A = 0.5 * (A + A.conj().T)
        nu, Z = np.linalg.eigh(A)
        nu, Z = nu[::-1], Z[:, ::-1]
        resolved = nu > TOO_STIFF * largest
        nu, Z = nu[resolved], Z[:, resolved] / np.sqrt(nu[resolved])
        dropped = len(D[0]) - held.shape[1] - len(nu)
        root = np.sqrt(d)
        blocks.append(_Block(1.0 / np.sqrt(nu), (V * root) @ Z, (V / root) @ Z, held.shape[1], dropped))
    return blocks


def _coupled(G: Array, least: float) -> Array:
    """Orthonormal directions (size, r) of the rows of G (m, size) with singular values above `least`."""
    if not G.size:
        return np.zeros((G.shape[1], 0), dtype=G.dtype)
    _, values, rows = np.linalg.svd(G, full_matrices=False)
    return rows[values > least].conj().T


def _kept(blocks: list[_Block], L: int, count: int | None, highest: float) -> tuple[Array, list[int]]:
    """Frequencies of the kept real modes, harmonic by harmonic, and the number of kept waves of each."""
    every = np.sort(np.concatenate([np.repeat(b.omega, _multiplicity(k, L)) for k, b in enumerate(blocks)]))
    kept = int(np.searchsorted(every, highest, side="right"))
    kept = kept if count is None else min(kept, count)
    while 0 < kept < len(every) and every[kept] <= every[kept - 1] * (1.0 + SAME_FREQUENCY):
        kept += 1
    cut = np.nextafter(every[kept - 1], np.inf) if kept else 0.0
    ends = [int(np.searchsorted(b.omega, cut)) for b in blocks]
    omega = [np.repeat(b.omega[:end], _multiplicity(k, L)) for k, (b, end) in enumerate(zip(blocks, ends, strict=True))]
    return np.concatenate(omega), ends


def _real(waves: Array, k: int, L: int) -> Array:
    """Waves (size, p) of harmonic k as real fields over all sectors (L size, p or 2 p), the two of a pair together."""
    if _multiplicity(k, L) == 1:
        sign = np.ones(L) if k == 0 else (-1.0) ** np.arange(L)
        return np.multiply.outer(sign, np.real(waves)).reshape(L * len(waves), -1) / np.sqrt(L)
    wave = np.exp(2j * np.pi * k * np.arange(L) / L)
    field = np.multiply.outer(wave, waves).reshape(L * len(waves), -1)
    return np.stack([np.real(field), np.imag(field)], axis=2).reshape(len(field), -1) * np.sqrt(2.0 / L)


def leaning(contact: Any, port: Any) -> float:
    """s R/R* of the surface of `port` in `contact`; 0 of surfaces in point contact, and of bodies
    without a stated material."""
    if any(other.surface.shape.profile().crown for other in contact.ports):
        return 0.0
    own, whole = compliance(port), sum(compliance(other) for other in contact.ports)
    if own == 0.0:
        return 0.0
    relative = sum(curvature(other.surface) for other in contact.ports)
    return own / whole * relative * _radius(port.surface)


def leanings(contacts: Iterable[Any]) -> dict[tuple[int, str], float]:
    """`leaning` by (index of the body, surface) of all surfaces with a compliance of slopes: the mean over their
    pairs."""
    found: dict[tuple[int, str], list[float]] = {}
    for contact in contacts:
        for port in contact.ports:
            if getattr(port.surface, "slope_lags", None) is not None:
                found.setdefault((port.body.index, port.name), []).append(leaning(contact, port))
    return {place: float(np.mean(values)) for place, values in found.items()}


def leant(surface: Any, by: float) -> Any:
    """The contact surface with the compliance D + `by` S."""
    return surface if by == 0.0 else replace(surface, lags=surface.lags + by * surface.slope_lags)


def curvature(surface: Any) -> float:
    """Around the axis [1/m]; of a bore negative, of a plane zero."""
    shape = surface.shape
    return 0.0 if shape.profile().planar else float(shape.side / _radius(surface))


def _radius(surface: Any) -> float:
    """At mid-width [m]."""
    z = 0.0 if surface.grid is None else float(np.mean(surface.grid.z[[0, -1]]))
    return float(surface.shape.radius_at(z))


def compliance(port: Any) -> float:
    """(1 - nu^2)/E [1/Pa]; 0 of a rigid body, and of one without a stated material."""
    reduced = port.body.reduced
    known = {} if reduced is None else reduced.provenance
    material = known.get("contact_materials", {}).get(port.surface.name)
    return 0.0 if material is None else (1.0 - material["poisson_ratio"] ** 2) / material["youngs_modulus"]
