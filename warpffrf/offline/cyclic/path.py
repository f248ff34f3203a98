r"""The cyclic path: a rotationally periodic body, one harmonic after the other.

Only the matrices of one sector are assembled. In each harmonic k = 0..N/2 the responses to the loads of one sector's
traction functions are computed, the global modes of that harmonic are projected out, and the residual compliance
`D_k = M_k^-1 C_k M_k^-1` and the observed values are stored; since deflation is within the harmonic, the result
stays block-circulant and

    lags[l] = 1/N sum_k D_k e^{i k l phi}

is an inverse FFT.

The matrices are real in the coordinates of `waves` on most meshes, and a complex load is two real ones there. All loads
of all fields act on few dofs (those of the surface's nodes): with more loads than dofs, unit loads on these dofs are
solved instead, `G F = (G E) (E^T F)`, so that tangential fields cost few solves in addition to the normal one.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import outer_faces, rigid_modes, triangles
from warpffrf.model.reduced.contact_surface import Recovery, Tangential
from warpffrf.model.reduced.data import Interface
from warpffrf.offline.bases.modes import attachment_modes, global_basis
from warpffrf.offline.contact.local_mass import HarmonicMass, slope_lags, window_columns
from warpffrf.offline.cyclic.harmonics import AxialInterface, HarmonicModes, Harmonics, RealModes, vibrations
from warpffrf.offline.cyclic.inertia import (
    CyclicObserver,
    ObservedModes,
    TurningWaves,
    cyclic_inertia_terms,
    left_out_products,
    selected_dofs,
    turning_waves,
)
from warpffrf.offline.cyclic.sector import Sector, assemble_sector, sector_axes
from warpffrf.offline.cyclic.surface import CyclicCross, CyclicField, CyclicSurface, FacetPattern, by_distance
from warpffrf.offline.elastic import Array, ElasticModel
from warpffrf.offline.fe import Assignment, Sparse
from warpffrf.offline.inertia.invariants import TurningResponse, covered_modes, covering_turning, left_out
from warpffrf.offline.interfaces import BodyInterface
from warpffrf.offline.products import Limits, PathProduct, SurfaceProduct, mass_properties
from warpffrf.offline.progress import Progress
from warpffrf.offline.quality import sampled_residual

SKIN = "skin"  # name of the observer of the display surface
REAL_LOADS = 1e-12  # imaginary part of loads, relative to the largest, that is round-off of the wave's phases


def axes_of(mesh: Mesh) -> Array:
    """Axes (3, 3) of sector 0 of a periodic mesh in columns: towards its first node, circumferential, axial."""
    cyclic = mesh.cyclic
    if cyclic is None:
        raise ValueError("axes_of needs a periodic mesh")
    axis = cyclic.axis_direction
    first = mesh.points[0] - cyclic.axis_point
    toward = first if np.linalg.norm(np.cross(first, axis)) > 0.0 else np.eye(3)[int(np.argmin(np.abs(axis)))]
    return sector_axes(axis, toward)


def reduce_cyclic(
    mesh: Mesh,
    assignment: Assignment,
    interfaces: Sequence[BodyInterface],
    surfaces: list[tuple[str, object, FacetPattern]],
    limits: Limits,
    spacing: Mapping[str, float | None],
    progress: Progress,
    *,
    traction: str = "nodes",
    tangential: str | None = None,
    observers: Sequence[CyclicObserver] = (),
    sloping: Collection[str] = (),
    local_dynamics: bool = False,
    inertia_modes: int | None = None,
    centrifugal: bool = False,
) -> PathProduct:
    """Reduce a periodic mesh: rigid `interfaces` on its axis, `surfaces` with resolved shape and facet pattern.
    See the module docstring.

    `spacing` of the contact grid by surface [m] (None: the mesh's own); `traction`, `tangential`: kind of the functions
    of normal and of tangential tractions ("nodes", "cells"; None: no tangential ones). `observers` are added to the
    display skin. `sloping`: surfaces for which the compliance of slopes is stored. `local_dynamics`: also compute the
    mass of the normal local modes. `inertia_modes`: number of modes with inertia terms (None: `invariants.MODES`);
    `centrifugal`: also attachment modes of rotation.
    """
    # matrices of one sector, interfaces on the axis, and contact grids
    with progress.stage("sector"):
        sector = assemble_sector(mesh, assignment, axes_of(mesh))
        N, nn = sector.count, sector.nodes
        heights = [float((i.point - sector.origin) @ sector.axes[:, 2]) for i in interfaces]
        on_axis = [AxialInterface(i.nodes[i.nodes < nn], h) for i, h in zip(interfaces, heights, strict=True)]
        contacts = [
            CyclicSurface(mesh, sector, name, shape, pattern, spacing.get(name), traction, tangential, name in sloping)
            for name, shape, pattern in surfaces
        ]
        loaded = [field.loaded_nodes() for s in contacts for field in s.fields]
        harmonics = Harmonics(sector, on_axis, np.unique(np.concatenate(loaded)) if loaded else None)
        skin, skin_triangles = _skin(mesh, nn)
        skin_dofs = (3 * skin[:, None] + np.arange(3)).ravel()
    looking = [selected_dofs(SKIN, skin_dofs, 3 * nn), *observers]

    # vibration modes by harmonic
    mass, center, inertia = mass_properties(_rigid_mass(sector), sector.origin)
    height = float((center - sector.origin) @ sector.axes[:, 2])
    found, facts = vibrations(harmonics, limits, progress)
    results = [
        _SurfaceResults(s, [o.rows for o in looking], local_dynamics, contacts[:i]) for i, s in enumerate(contacts)
    ]
    modes_of: list[HarmonicModes] = []
    turned: dict[int, tuple[TurningWaves, TurningResponse]] = {}
    dropped = 0
    worst: list[float] = []
    # each harmonic: global modes, responses to the loads of rotation, residual responses to the unit loads
    for k in progress.track(range(N // 2 + 1), "static responses"):
        omega, Phi = np.zeros(0), np.zeros((0, 0))
        Q = harmonics.waves.basis(k)
        T = sp.csr_matrix(Q @ harmonics.constraint(k))  # sector displacement from the coordinates of this harmonic
        turning = turning_waves(harmonics, k, height)
        if k < 2 or k in found or (centrifugal and turning.loads.shape[1]):
            model, V = found.pop(k, None) or (harmonics.model(k), None)
            flexibility = _of_complex(model)
            V = np.zeros((model.size, 0)) if V is None else V
            applied = [harmonics.interface_loads(k), *([turning.loads] if centrifugal else [])]
            omega, Phi, cut = global_basis(model, V, attachment_modes(model, np.concatenate(applied, axis=1)))
            dropped += cut
        else:
            flexibility = harmonics.factor(k).solve
        if turning.loads.shape[1]:
            u = flexibility(turning.loads)
            shapes = Phi if len(omega) else np.zeros((len(u), 0))
            turned[k] = turning, TurningResponse.of(harmonics.mass(k), turning.loads, u, omega, shapes)
        B = [[field.load(k) for field in s.fields] for s in contacts]
        F = [[sp.csr_matrix(T.conj().T @ b) for b in of_surface] for of_surface in B]
        if k < 2 or k == N // 2:
            tested = model if k < 2 else harmonics.model(k)
            worst += [sampled_residual(tested, f, _of_complex(tested)) for of_surface in F for f in of_surface]
        views = [sp.csr_matrix(o.harmonic(k, N) @ T) for o in looking]
        if len(omega):
            shape = T @ Phi
            coefficients = [
                [field.without_gram(k, b.conj().T @ shape) for field, b in zip(s.fields, of_surface, strict=True)]
                for s, of_surface in zip(contacts, B, strict=True)
            ]
            observed = [view @ Phi for view in views]
            modes_of.append(HarmonicModes(k, omega, shape, harmonics.interface_motion(k, Phi), coefficients, observed))
        M = harmonics.mass(k) if local_dynamics and results else None
        for i, (result, loads) in enumerate(zip(results, F, strict=True)):
            around = result.surface.around
            along = None if around is None else sp.csr_matrix(T.conj().T @ around.load(k))
            result.add(k, loads, views, flexibility, omega, Phi, M, along, F[:i])

    # real modes and inertia terms of the whole body
    modes = RealModes(N, modes_of)
    facts.update(
        modes.facts(),
        dependent_directions_dropped=dropped,
        sectors=N,
        nodes_per_sector=nn,
        harmonics="real" if harmonics.waves.mirrored else "complex",
        worst_load_residual=max(worst, default=None),
        widest_block=harmonics.pattern.widest,
    )
    with progress.stage("inertia terms"):
        kept = covered_modes(modes.omega, inertia_modes)

        def lacking(limit: float) -> float:
            return left_out(left_out_products(turned, harmonics, limit), inertia)

        if centrifugal and inertia_modes is None:
            kept = covering_turning(modes.omega, kept, lacking)
        facts["centrifugal_left_out"] = lacking(float(modes.omega[kept - 1]) if kept else 0.0)
        terms = cyclic_inertia_terms(sector, modes_of, kept, center)
    return PathProduct(
        mass=mass,
        center=center,
        inertia=inertia,
        omega=modes.omega,
        interfaces={
            i.name: Interface(i.kind, i.point, modes.interface_motion(j, sector.axes)) for j, i in enumerate(interfaces)
        },
        surfaces=[
            result.product(N, sector.axes, [o.name for o in observers], modes, [h.fields[i] for h in modes_of])
            for i, result in enumerate(results)
        ],
        skin_points=mesh.points.reshape(N, nn, 3)[:, skin].reshape(-1, 3),
        skin_triangles=skin_triangles,
        skin_modes=modes.skin(skin_dofs, sector.axes),
        facts=facts,
        observed_modes={
            o.name: ObservedModes([(h.k, h.observed[i]) for h in modes_of], o.rows, modes.combine)
            for i, o in enumerate(looking[1:], start=1)
        },
        inertia_terms=terms,
        cross=[cross.product() for result in results for cross in result.cross],
    )


class _SurfaceResults:
    """Operators of one contact surface, accumulated harmonic by harmonic."""

    def __init__(
        self, surface: CyclicSurface, rows: list[int], local_dynamics: bool, earlier: list[CyclicSurface]
    ) -> None:
        self.surface = surface
        harmonics = surface.N // 2 + 1
        counts = [field.count for field in surface.fields]
        # residual compliance [field][field], for the first field also that with the global modes' part
        self.C = {
            (a, b): np.zeros((harmonics, counts[a], counts[b]), dtype=complex)
            for a in range(len(counts))
            for b in range(a, len(counts))
        }
        self.whole = np.zeros_like(self.C[0, 0])
        self.transfer = [[np.zeros((harmonics, r, n), dtype=np.complex64) for n in counts] for r in rows]
        self.mass = HarmonicMass(surface.normal) if local_dynamics else None
        self.along = None if surface.around is None else np.zeros_like(self.whole)  # around under normal loads
        self.cross = [CyclicCross(target, surface) for target in earlier]

    def add(
        self,
        k: int,
        loads: list[Sparse],
        views: list[Sparse],
        flexibility,
        omega: Array,
        Phi: Array,
        M: Sparse | None = None,
        along: Sparse | None = None,
        earlier: Sequence[list[Sparse]] = (),
    ) -> None:
        """Harmonic k: sparse `loads` (n, count) of each field, operators `views` (rows, n) of the observers, the mass
        matrix M if the mass of local modes is computed, loads `along` (n, count) if slopes are, loads of each field
        of the `earlier` surfaces."""
        touched = np.flatnonzero(sum(np.diff(load.indptr) for load in loads))
        phases = [field.phases(k) for field in self.surface.fields]
        units = np.concatenate([(f @ sp.diags(p)).toarray() for f, p in zip(loads, phases, strict=True)], axis=1)
        if np.abs(np.imag(units)).max(initial=0.0) <= REAL_LOADS * np.abs(np.real(units)).max(initial=0.0):
            units = np.real(units)
        direct = units.shape[1] * (2 if np.iscomplexobj(units) else 1) <= len(touched)
        if direct:
            parts = [np.eye(len(units[0]))[:, c] * p.conj() for c, p in zip(_columns(loads), phases, strict=True)]
        else:
            units = np.zeros((len(units), len(touched)))
            units[touched, np.arange(len(touched))] = 1.0
            parts = [load[touched].toarray() for load in loads]
        response = flexibility(units)
        G = units.conj().T @ response if direct else response[touched]
        seen = [view @ response for view in views]
        on_modes = [load.conj().T @ Phi / omega for load in loads] if len(omega) else []
        view_modes = [(view @ Phi) / omega for view in views] if len(omega) else []
        for (a, b), C in self.C.items():
            C[k] = parts[a].conj().T @ G @ parts[b]
            if (a, b) == (0, 0):
                self.whole[k] = C[k]
            if len(omega):
                C[k] -= on_modes[a] @ on_modes[b].conj().T
            if a == b:
                C[k] = 0.5 * (C[k] + C[k].conj().T)
        if self.mass is not None and M is not None:
            u = response @ parts[0]
            if len(omega):
                u = u - (Phi / omega) @ on_modes[0].conj().T
            self.mass.add(k, M, u, Phi if len(omega) else np.zeros((len(u), 0)))
        if self.along is not None and along is not None:
            self.along[k] = (along.conj().T @ response) @ parts[0]
            if len(omega):
                self.along[k] -= ((along.conj().T @ Phi) / omega) @ on_modes[0].conj().T
        for cross, targets in zip(self.cross, earlier, strict=True):
            cross.add(k, targets, response, parts, Phi / omega if len(omega) else None, on_modes)
        for number, y in enumerate(seen):
            for a, field in enumerate(self.surface.fields):
                values = y @ parts[a]
                if len(omega):
                    values = values - view_modes[number] @ on_modes[a].conj().T
                self.transfer[number][a][k] = field.without_gram(k, values.conj().T).conj().T

    def product(
        self, N: int, axes: Array, names: list[str], modes: RealModes, coefficients: list[list[Array]]
    ) -> SurfaceProduct:
        """The finished operators; `coefficients` of each harmonic's modes in each field."""
        s = self.surface
        recoveries = [[Recovery(t, N, axes, s.offset, s.stride) for t in of_fields] for of_fields in self.transfer]
        sampled = [
            ObservedModes(
                [(h.k, c[a]) for h, c in zip(modes.found, coefficients, strict=True)], f.count, modes.combine
            ).real(f.projected)
            for a, f in enumerate(s.fields)
        ]
        tangential = None
        if s.tangential is not None:
            tangential = Tangential(
                s.tangential.grid(),
                self._lags(1, 1),
                self._lags(0, 1),
                np.ascontiguousarray(sampled[1].reshape(2, len(sampled[1]) // 2, -1)),
                recoveries[0][1],
            )
        whole, residual = (_window(np.fft.irfft(c, n=N, axis=0)[:: s.stride], s) for c in (self.whole, self.C[0, 0]))
        return SurfaceProduct(
            s.normal.grid(),
            self._lags(0, 0),
            sampled[0],
            recoveries[0][0],
            whole,
            residual,
            s.traces,
            tangential=tangential,
            slope_lags=self._slope_lags(),
            local_mass=None if self.mass is None else self.mass.product(modes.combine),
            observed={name: r[0] for name, r in zip(names, recoveries[1:], strict=True)},
            observed_tangential={name: r[1] for name, r in zip(names, recoveries[1:], strict=True) if len(r) > 1},
            first_column=s.first,
            whole_columns=s.plan.columns // s.stride,
        )

    def _slope_lags(self) -> Array | None:
        s = self.surface
        if self.along is None or s.around is None:
            return None
        return slope_lags(self._blocks(self.along, s.around, s.normal), s.normal.pitch, s.normal.rows)

    def _lags(self, a: int, b: int) -> Array:
        """Blocks of D between fields a and b, by distance in sectors."""
        return self._blocks(self.C[a, b], self.surface.fields[a], self.surface.fields[b])

    def _blocks(self, of_harmonics: Array, first: CyclicField, second: CyclicField) -> Array:
        """M_first^-1 C M_second^-1 by distance in sectors."""
        return np.ascontiguousarray(by_distance(of_harmonics, first, second)[:: self.surface.stride])


def _columns(loads: list[Sparse]) -> list[slice]:
    stops = np.cumsum([load.shape[1] for load in loads])
    return [slice(int(stop) - load.shape[1], int(stop)) for stop, load in zip(stops, loads, strict=True)]


def _of_complex(model: ElasticModel):
    """The flexibility of `model`, for complex loads too if its matrices are real."""

    def flexibility(F: Array) -> Array:
        if np.iscomplexobj(F) and not np.iscomplexobj(model.K.data):
            return model.flexibility(np.real(F)) + 1j * model.flexibility(np.imag(F))
        return model.flexibility(F)

    return flexibility


def _window(lags: Array, s: CyclicSurface) -> Array:
    """C of the first columns, all rows."""
    rows = s.normal.rows
    j = np.arange(window_columns(s.normal.columns, rows))
    lag = (j[:, None] // s.c - j[None, :] // s.c) % len(lags)
    blocks = lags.reshape(len(lags), s.c, rows, s.c, rows)[lag, (j % s.c)[:, None], :, (j % s.c)[None, :], :]
    return blocks.transpose(0, 2, 1, 3).reshape(len(j) * rows, -1)


def _rigid_mass(sector: Sector) -> Array:
    """R^T M R (6, 6) of the whole body about the axis point, user axes: the sum over rotated sectors."""
    A, B = sector.M
    turn = np.zeros((3, 3))
    c, s = np.cos(sector.phi), np.sin(sector.phi)
    turn[:] = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
    R = rigid_modes(sector.coordinates, np.zeros(3))
    both = np.zeros((6, 6))
    both[:3, :3] = both[3:, 3:] = turn
    # the rigid motion in the axes of sector 1: rotate the motion back, keep the coordinates
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
