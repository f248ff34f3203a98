r"""The cyclic path: a rotationally periodic body, one harmonic after the other.

Only the matrices of one sector are assembled. In each harmonic k = 0..N/2 the loads of one sector's hats are solved,
the global modes of that harmonic are found and taken out, and the residual compliance `D_k = M_k^-1 C_k M_k^-1` and the
display transfer are stored; since deflation happens within the harmonic, the result stays block-circulant and

    lags[l] = 1/N sum_k D_k e^{i k l phi}

is an inverse FFT. A complex mode `u` of harmonic 0 < k < N/2 with `u^H M_k u = 1` stands for the two real modes
`sqrt(2/N) Re, Im (u e^{i k s phi})`; one of k = 0 or N/2 for `u e^{i k s phi}/sqrt(N)`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import outer_faces, triangles
from warpffrf.model.reduced_body import Recovery, sector_to_user
from warpffrf.offline.assembly import rigid_modes
from warpffrf.offline.cyclic_surface import CyclicSurface, FacetPattern
from warpffrf.offline.elastic import Array
from warpffrf.offline.global_basis import attachment_modes, deflated, global_basis
from warpffrf.offline.harmonics import DIRECTIONS, AxialInterface, Harmonics
from warpffrf.offline.independence import window_columns
from warpffrf.offline.interfaces import RigidInterface
from warpffrf.offline.materials import Assignment
from warpffrf.offline.modes import SAME_FREQUENCY, vibration_modes, whole_multiples
from warpffrf.offline.products import Limits, PathProduct, SurfaceProduct, mass_properties
from warpffrf.offline.progress import Progress
from warpffrf.offline.sector import Sector, assemble_sector, sector_axes

LIMIT_GROWTH = 1.35  # factor by which the frequency limit grows until it holds the wanted number of modes


@dataclass
class HarmonicModes:
    """Global modes of one harmonic: omega (p,), sector displacement (3 nn, p), interface amplitudes (2 i, p), and on
    each contact surface the hat coefficients of the normal displacement (hats, p)."""

    k: int
    omega: Array
    shape: Array
    interface: Array
    normal: list[Array]


def reduce_cyclic(
    mesh: Mesh,
    assignment: Assignment,
    interfaces: list[RigidInterface],
    surfaces: list[tuple[str, object, FacetPattern]],
    limits: Limits,
    spacing: float | None,
    progress: Progress,
) -> PathProduct:
    """Reduce a periodic mesh; `surfaces` are name, resolved shape and facet pattern. See the module docstring."""
    cyclic = mesh.cyclic
    if cyclic is None:
        raise ValueError("reduce_cyclic needs a periodic mesh")
    axis = cyclic.axis_direction
    first = mesh.points[0] - cyclic.axis_point
    toward = first if np.linalg.norm(np.cross(first, axis)) > 0.0 else np.eye(3)[int(np.argmin(np.abs(axis)))]
    sector = assemble_sector(mesh, assignment, sector_axes(axis, toward))
    N, nn = sector.count, sector.nodes
    on_axis = [AxialInterface(i.nodes[i.nodes < nn], float((i.point - sector.origin) @ axis)) for i in interfaces]
    harmonics = Harmonics(sector, on_axis)
    contacts = [CyclicSurface(mesh, sector, name, shape, pattern, spacing) for name, shape, pattern in surfaces]
    skin, skin_triangles = _skin(mesh, nn)
    skin_dofs = (3 * skin[:, None] + np.arange(3)).ravel()

    vibrations, facts = _vibrations(harmonics, limits, progress)
    count = N // 2 + 1
    D = [np.zeros((count, s.hats, s.hats), dtype=complex) for s in contacts]
    C = [np.zeros((count, s.hats, s.hats), dtype=complex) for s in contacts]
    whole = [np.zeros_like(c) for c in C]  # compliance with the global modes' part
    transfer = [np.zeros((count, len(skin_dofs), s.hats), dtype=np.complex64) for s in contacts]
    found: list[HarmonicModes] = []
    dropped = 0
    for k in progress.track(range(count), "static responses"):
        omega, Phi, cut = np.zeros(0), np.zeros((0, 0)), 0
        T = harmonics.constraint(k)
        TH = T.conj().T
        loads = [s.load(k) for s in contacts]
        if k < 2 or k in vibrations:
            model = harmonics.model(k)
            flexibility = model.flexibility
            V = vibrations.get(k, np.zeros((model.size, 0)))
            omega, Phi, cut = global_basis(model, V, attachment_modes(model, harmonics.interface_loads(k)))
            dropped += cut
        else:
            flexibility = harmonics.solver(k)
        if len(omega):
            shape = T @ Phi
            normal = [s.without_gram(k, B.conj().T @ shape) for s, B in zip(contacts, loads, strict=True)]
            found.append(HarmonicModes(k, omega, shape, Phi[len(harmonics.free) :], normal))
        for i, s in enumerate(contacts):
            F = TH @ loads[i]
            response = flexibility(F)
            whole[i][k] = F.conj().T @ response
            if len(omega):
                response, C[i][k] = deflated(response, F, omega, Phi)
            else:
                C[i][k] = whole[i][k]
            D[i][k] = s.without_gram(k, s.without_gram(k, C[i][k]).conj().T)
            skin_response = (T @ response)[skin_dofs]
            transfer[i][k] = s.without_gram(k, skin_response.conj().T).conj().T

    modes = _RealModes(N, found)
    facts.update(
        modes.facts(),
        dependent_directions_dropped=dropped,
        sectors=N,
        nodes_per_sector=nn,
        half_bandwidth=harmonics._width,
    )
    products = []
    for i, s in enumerate(contacts):
        lags = np.fft.irfft(D[i], n=N, axis=0)[:: s.stride]
        windows = [_window(np.fft.irfft(c[i], n=N, axis=0)[:: s.stride], s) for c in (whole, C)]
        recovery = Recovery(transfer[i], N, sector.axes, s.offset, s.stride)
        normal = modes.combine([s.sampled(m.k, m.normal[i]) for m in found])
        products.append(SurfaceProduct(s.grid, np.ascontiguousarray(lags), normal, recovery, *windows))

    mass, center, inertia = mass_properties(_rigid_mass(sector), sector.origin)
    return PathProduct(
        mass=mass,
        center=center,
        inertia=inertia,
        omega=modes.omega,
        interface_modes=[modes.interface_motion(j, sector.axes) for j in range(len(interfaces))],
        surfaces=products,
        skin_points=mesh.points.reshape(N, nn, 3)[:, skin].reshape(-1, 3),
        skin_triangles=skin_triangles,
        skin_modes=modes.skin(skin_dofs, sector.axes),
        facts=facts,
    )


def _vibrations(harmonics: Harmonics, limits: Limits, progress: Progress) -> tuple[dict[int, Array], dict]:
    """Vibration modes by harmonic: {k: V (n_k, p)}, whole pairs only, and what was rounded."""
    if limits.none:
        return {}, {}
    last = harmonics.count // 2
    if limits.omega_max is not None:
        found = _modes_up_to(harmonics, limits.omega_max, progress)
    else:
        # a limit that holds at least one mode, then larger ones until it holds enough (or nothing is added any more)
        lowest = [vibration_modes(harmonics.model(k), count=1)[0] for k in range(min(3, last + 1))]
        limit, found, before = LIMIT_GROWTH * min(float(w[0]) for w in lowest if len(w)), {}, -1
        total = sum(harmonics.multiplicity(k) * harmonics.model(k).size for k in range(last + 1))
        while _number(harmonics, found) < min(limits.count or 0, total) and before < total:
            found = _modes_up_to(harmonics, limit, progress)
            limit *= LIMIT_GROWTH
            before = _number(harmonics, found)
            if before >= total - 6:
                break
    facts: dict = {}
    if limits.count is not None:
        omega = np.sort(np.concatenate([np.repeat(w, harmonics.multiplicity(k)) for k, (w, _) in found.items()]))
        kept = whole_multiples(omega, limits.count)
        if kept > limits.count:
            facts["notes"] = [f"modes={limits.count} would split a pair of equal frequencies: {kept} are kept"]
        cut = omega[kept - 1] * (1.0 + SAME_FREQUENCY) if kept else 0.0
        found = {k: (w[w <= cut], V[:, w <= cut]) for k, (w, V) in found.items()}
    return {k: V for k, (w, V) in found.items() if len(w)}, facts


def _number(harmonics: Harmonics, found: dict[int, tuple[Array, Array]]) -> int:
    return sum(harmonics.multiplicity(k) * len(w) for k, (w, _) in found.items())


def _modes_up_to(harmonics: Harmonics, omega: float, progress: Progress) -> dict[int, tuple[Array, Array]]:
    found = {}
    for k in progress.track(range(harmonics.count // 2 + 1), "vibration modes"):
        if k < 2 or harmonics.has_modes(k, omega):
            w, V = vibration_modes(harmonics.model(k), omega_max=omega)
            if len(w):
                found[k] = (w, V)
    return found


class _RealModes:
    """The complex modes of all harmonics as real modes, ascending in frequency, the two of a pair beside each other."""

    def __init__(self, N: int, found: list[HarmonicModes]) -> None:
        self.N, self.found = N, found
        omega, self._kinds = [], []
        for h in found:
            pair = 0 < h.k and 2 * h.k != N
            for w in h.omega:
                omega += [w] * (2 if pair else 1)
            self._kinds.append(pair)
        self._order = np.argsort(np.array(omega), kind="stable")
        self.omega = np.array(omega)[self._order]

    def combine(self, waves: list[Array]) -> Array:
        """Real fields (rows, m) from the complex waves (rows, p) of each harmonic."""
        columns = []
        for wave, pair in zip(waves, self._kinds, strict=True):
            if pair:
                scale = np.sqrt(2.0 / self.N)
                columns.append(np.stack([np.real(wave), np.imag(wave)], axis=2).reshape(len(wave), -1) * scale)
            else:
                columns.append(np.real(wave) / np.sqrt(self.N))
        if not columns:
            return np.zeros((0, 0))
        return np.concatenate(columns, axis=1)[:, self._order]

    def interface_motion(self, j: int, axes: Array) -> Array:
        """Translation and rotation (m, 6) of interface j, user axes."""
        waves = []
        for h in self.found:
            motion = np.zeros((6, len(h.omega)), dtype=complex)
            if h.k in DIRECTIONS:
                d = axes @ DIRECTIONS[h.k]
                motion[:3] = d[:, None] * h.interface[2 * j]
                motion[3:] = d[:, None] * h.interface[2 * j + 1]
            waves.append(motion)
        return self.combine(waves).T if waves else np.zeros((0, 6))

    def skin(self, dofs: Array, axes: Array) -> Array:
        """Displacement of the display points (m, n, 3) float32, user axes."""
        N, points = self.N, len(dofs) // 3
        fields = np.zeros((len(self.omega), N * points, 3), dtype=np.float32)
        place = np.argsort(self._order)
        row = 0
        for h, pair in zip(self.found, self._kinds, strict=True):
            wave = np.exp(2j * np.pi * h.k * np.arange(N) / N)[:, None, None]
            for p in range(len(h.omega)):
                u = wave * h.shape[dofs, p].reshape(1, points, 3)
                parts = (u.real, u.imag) if pair else (u.real,)
                scale = np.sqrt(len(parts) / N)
                for part in parts:
                    fields[place[row]] = scale * sector_to_user(part, axes)
                    row += 1
        return fields

    def facts(self) -> dict:
        """Harmonics that carry global modes, for the report."""
        return {"harmonics_with_modes": [int(h.k) for h in self.found]}


def _window(lags: Array, s: CyclicSurface) -> Array:
    """C of the first columns, all rows."""
    j = np.arange(window_columns(s.grid.columns, s.rows))
    lag = (j[:, None] // s.c - j[None, :] // s.c) % len(lags)
    blocks = lags.reshape(len(lags), s.c, s.rows, s.c, s.rows)[lag, (j % s.c)[:, None], :, (j % s.c)[None, :], :]
    return blocks.transpose(0, 2, 1, 3).reshape(len(j) * s.rows, -1)


def _rigid_mass(sector: Sector) -> Array:
    """R^T M R (6, 6) of the whole body about the axis point, user axes: the sum over turned sectors."""
    A, B = sector.M
    turn = np.zeros((3, 3))
    c, s = np.cos(sector.phi), np.sin(sector.phi)
    turn[:] = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
    R = rigid_modes(sector.coordinates, np.zeros(3))
    both = np.zeros((6, 6))
    both[:3, :3] = both[3:, 3:] = turn
    # the rigid motion as sector 1 sees it in its own axes: turn back the motion, keep the coordinates
    R_next = R @ both.T
    J = R.T @ (A @ R) + R.T @ (B @ R_next) + R_next.T @ (B.T @ R)
    total = np.zeros((6, 6))
    for i in range(sector.count):
        a = i * sector.phi
        Q = sector.axes @ np.array([[np.cos(a), -np.sin(a), 0.0], [np.sin(a), np.cos(a), 0.0], [0.0, 0.0, 1.0]])
        both = np.zeros((6, 6))
        both[:3, :3] = both[3:, 3:] = Q
        total += both @ J @ both.T
    return total


def _skin(mesh: Mesh, nn: int) -> tuple[Array, Array]:
    """Skin nodes of sector 0 (p,), and all triangles (t, 3) numbered sector-major over the skin points."""
    N = len(mesh.points) // nn
    near, inner = {}, {}
    for kind, nodes in mesh.cells.items():
        cells = nodes.reshape(N, -1, nodes.shape[1])
        near[kind] = np.concatenate([cells[s] for s in dict.fromkeys((0, 1, N - 1))])
        inner[kind] = cells.shape[1]
    faces = outer_faces(near, inner)
    skin = np.unique(faces.node_set % nn)
    corner = triangles(faces)
    local = (corner // nn) * len(skin) + np.searchsorted(skin, corner % nn)
    shift = len(skin) * np.arange(N)[:, None, None]
    return skin, ((local[None] + shift) % (N * len(skin))).reshape(-1, 3)
