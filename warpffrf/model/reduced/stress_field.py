r"""Stress of a reduced body at chosen points, from its modal coordinates and the forces on contact surfaces and matched
faces.

A stress is six numbers in the order xx, yy, zz, xy, yz, zx [Pa] (tensor components, no factor 2), axes of the user
frame. At point x

    sigma(x) = sum_i modes_i(x) q_i + sum_loads [T(x) f + W(x) s],      s = M^-1 f,

with `q` the global coordinates, `f` the forces `f_i = int psi_i t dA` [N] of the grid functions of a contact surface,
outward normal ones (columns, rows) or tangential ones (2, columns, rows), `T` the response of the local modes, `s` the
coefficients of the traction `t = sum_i psi_i s_i` equivalent to the forces, and `M` the Gram matrix. `W` is the part
that follows from the traction alone, without any deformation: see `warpffrf.offline.stress.operator`. It makes the
traction on a contact surface equal to the applied one. Forces s on the cells of matched faces add `sum_i matched_i(x)
s_i`, the response of the residual flexibility to them; on the faces of a matched face themselves it is the stress of
the finite elements. Amplitudes e of the membrane energy (`warpffrf.model.reduced.inertia`) add `sum_r membrane_r(x)
e_r`.

On a rotationally periodic body `T` is stored for the `p0` distinct positions of the points in one sector, in the axes
of that sector, per harmonic: `sigma_j = Re sum_k w_k e^{i k s_j phi} T_k f_k` at the position of point j, rotated into
user axes, with `f_k` the harmonics of the forces and w_k = 1/N for k = 0 and N/2, else 2/N.

Skin strain. Strains of a body's skin, from the motion of its nodes.

An edge X of a triangle that deforms into X + u has the second-order strain

    e = (X.u + v.v/2)/|X|^2,      u of Phi q + Theta(q, q),      v of Phi q,

v.v/2 reduced by the part that Theta relieves (`warpffrf.model.reduced.inertia`); of bodies without Theta the linear
strain, as in their equations. It is the mean strain along the edge, correct on bending quadratic cells, where shears of
flat triangles are not: across a deep bend of cells much longer than thick these would be several times the actual
strain. Pressures on contact surfaces, local modes and internal notches are not included, and of shear only the part
along edges.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.contact_grid import meridian_gram
from warpffrf.model.reduced.contact_surface import Recovery
from warpffrf.model.reduced.inertia import motion_of, skin_displacement

_PLACE = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
_FIRST, _SECOND = np.array([0, 1, 2, 0, 1, 2]), np.array([0, 1, 2, 1, 2, 0])
SUMMED = 8  # points per position up to which a harmonic sum per point costs less than a fast transform over all sectors


@named_arguments
@dataclass(frozen=True, eq=False)
class StressPoints:
    """Points of stress: `points` (p, 3) [m, user frame], or the name of a facet set, whose stress is averaged over the
    cells of one `cell_set` only."""

    points: Any
    cell_set: str


def to_tensor(stress: np.ndarray) -> np.ndarray:
    """Symmetric tensors (..., 3, 3) of stresses (..., 6)."""
    return np.asarray(stress)[..., _PLACE]


def from_tensor(tensor: np.ndarray) -> np.ndarray:
    """Stresses (..., 6) of symmetric tensors (..., 3, 3)."""
    return tensor[..., _FIRST, _SECOND]


def rotated(stress: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Stresses (..., 6) given in axes that are the columns of `axes` (..., 3, 3), in the frame of those columns."""
    return from_tensor(axes @ to_tensor(stress) @ np.swapaxes(axes, -1, -2))


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Equivalent stress (...) [Pa] of stresses (..., 6): sqrt(3/2 s:s), s the deviator."""
    x, y, z, xy, yz, zx = np.moveaxis(np.asarray(stress), -1, 0)
    shear = xy**2 + yz**2 + zx**2
    return np.sqrt(0.5 * ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) + 3.0 * shear)


def principal(stress: np.ndarray) -> np.ndarray:
    """Principal stresses (..., 3) [Pa] of stresses (..., 6), largest first."""
    return np.linalg.eigvalsh(to_tensor(stress))[..., ::-1]


def max_shear(stress: np.ndarray) -> np.ndarray:
    """Largest shear stress (...) [Pa] of stresses (..., 6): half the difference of the outer principal stresses."""
    values = principal(stress)
    return 0.5 * (values[..., 0] - values[..., 2])


def sector_frames(axes: np.ndarray, sector: np.ndarray, sectors: int) -> np.ndarray:
    """Axes (p, 3, 3, in columns, user axes) of the sectors with the numbers `sector` (p,), rotated about the third."""
    angle = 2.0 * np.pi * np.asarray(sector) / sectors
    turn = np.zeros((len(angle), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1.0
    return axes @ turn


@dataclass(frozen=True)
class GridSpan:
    """The whole grid that covers the facets, and the position of the surface's grid in it: an arc is part of a full
    revolution (`closed`), on which the Gram matrix is then inverted, or of a larger arc with half nodes at its ends,
    which carry no traction. `columns` of the whole grid; column 0 of the surface is its column `first`."""

    first: int
    columns: int
    closed: bool

    def coefficients(self, forces: np.ndarray, kind: str, pitch: float, gram_z: np.ndarray) -> np.ndarray:
        """`M^-1 f` (d, whole columns, rows) [Pa] of forces (d, columns, rows) [N] on "nodes" or "cells"; M = M_theta
        (x) M_z, `pitch` [rad] between columns, `gram_z` (rows, rows) [m^2/rad]. M is that of the whole grid where it is
        closed, else that of the surface's own functions; others have zeros."""
        directions, columns, rows = forces.shape
        n = self.columns
        whole, place = np.zeros((directions, n, rows)), (self.first + np.arange(columns)) % n
        whole[:, place] = np.linalg.solve(gram_z, forces.reshape(-1, rows).T).T.reshape(forces.shape)
        if kind == "cells":
            return whole / pitch
        if self.closed:  # M_theta is circulant with the row pitch/6 (1, 4, 1)
            values = pitch * (2.0 + np.cos(2.0 * np.pi * np.arange(n // 2 + 1) / n)) / 3.0
            return np.fft.irfft(np.fft.rfft(whole, axis=1) / values[:, None], n=n, axis=1)
        from scipy.linalg import solveh_banded

        band = np.full((2, columns), pitch / 6.0)
        band[1] = 2.0 * pitch / 3.0
        around = solveh_banded(band, np.moveaxis(whole[:, place], 1, 0).reshape(columns, -1))
        whole[:, place] = np.moveaxis(around.reshape(columns, directions, rows), 0, 1)
        return whole


@dataclass(frozen=True, eq=False)
class LoadStress:
    """Stress at the points under the normal forces on one contact surface, or under the `tangential` ones.

    `transfer` [Pa/N] holds six rows per position, in the layout of `Recovery`; `own` (6 p, whole functions) sparse [-]
    acts on the traction coefficients over `span`. Functions are numbered by direction, column, row.
    """

    surface: Any  # ContactSurface
    transfer: Recovery
    own: Any
    span: GridSpan
    tangential: bool = False

    @property
    def grid(self) -> Any:
        """The grid of the forces: `SurfaceGrid`."""
        return self.surface.tangential.grid if self.tangential else self.surface.grid

    @property
    def kind(self) -> str:
        """Grid functions, "nodes" or "cells"; a `SurfaceGrid` holds nodes."""
        return getattr(self.grid, "kind", "nodes")

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the forces."""
        return (2, self.grid.columns, self.grid.rows) if self.tangential else (self.grid.columns, self.grid.rows)

    @cached_property
    def _gram_z(self) -> np.ndarray:
        return meridian_gram(self.kind, self.surface.shape, self.grid.z)

    def amplitudes(self, forces: np.ndarray) -> np.ndarray:
        """T_k f_k (harmonics, p0, 6) of forces (d, columns, rows) [N]; with one sector the stress itself."""
        t, c = self.transfer, self.grid.columns_per_sector
        if t.sectors == 1:
            return (t.transfer[0] @ forces.ravel().astype(t.transfer.dtype)).reshape(1, -1, 6)
        directions, columns, rows = forces.shape
        whole = np.zeros((directions, c * t.sectors, rows))
        whole[:, (t.offset + t.stride * np.arange(columns)) % whole.shape[1]] = forces
        by_sector = np.moveaxis(whole.reshape(directions, t.sectors, c, rows), 1, 0).reshape(t.sectors, -1)
        loads = np.fft.rfft(by_sector, axis=0).astype(t.transfer.dtype)
        return (t.transfer @ loads[:, :, None]).reshape(len(loads), -1, 6).astype(np.complex128)

    def of_traction(self, forces: np.ndarray) -> np.ndarray:
        """The part W s (p, 6) [Pa] that follows from the traction on the surface alone, user axes; forces
        (d, columns, rows) [N]."""
        s = self.span.coefficients(forces, self.kind, self.grid.pitch, self._gram_z)
        return np.asarray(self.own @ s.ravel()).reshape(-1, 6)


@dataclass(frozen=True, eq=False)
class StressField:
    """Stress recovery of one body at named points; see the module docstring.

    `points` (p, 3) [m, user frame]; `modes` (m, p, 6) [Pa] per unit modal coordinate; `normal` and `tangential` loads
    by contact surface. `place` (p,) and `sector` (p,) give the row block of a transfer and the sector of each point.
    """

    name: str
    points: np.ndarray
    modes: np.ndarray
    normal: dict[str, LoadStress]
    tangential: dict[str, LoadStress]
    place: np.ndarray
    sector: np.ndarray
    matched: np.ndarray | None = (
        None  # (N, p, 6) Pa/N, of each force on the body's matched faces; None without matched faces
    )
    membrane: np.ndarray | None = None  # (R, p, 6) Pa/J^(1/2), of each amplitude of the membrane energy; None without

    def evaluate(
        self,
        q: np.ndarray,
        forces: dict[str, np.ndarray],
        tangential: dict[str, np.ndarray] | None = None,
        matched: np.ndarray | None = None,
        membrane: np.ndarray | None = None,
    ) -> np.ndarray:
        """Stress (p, 6) [Pa], user axes, at global coordinates `q` (m,) under outward normal `forces` (columns, rows)
        and `tangential` ones (2, columns, rows) [N] on each contact surface that is loaded, and the forces `matched`
        (N,) [N] on all cells of all matched faces, in the order of `ReducedBody.matched_compliance`, and the amplitudes
        `membrane` (R,) [sqrt(J)] of the membrane energy.

        Raises `InputError` for an unknown surface, or an array of another shape.
        """
        q = np.asarray(q, dtype=np.float64)
        if q.shape != (len(self.modes),):
            raise InputError(f"stress {self.name!r}: {len(self.modes)} modal coordinates are needed, got {q.shape}")
        stress = np.tensordot(q.astype(self.modes.dtype), self.modes, axes=1).astype(np.float64)
        if matched is not None and np.any(matched):
            stress = stress + self._of("forces on matched faces", self.matched, matched)
        if membrane is not None:
            stress = stress + self._of("amplitudes of the membrane energy", self.membrane, membrane)
        for what, parts, loads in (("normal", self.normal, forces), ("tangential", self.tangential, tangential or {})):
            for name, load in loads.items():
                if name not in parts:
                    raise unknown_name(f"stress {self.name!r}: {what} load on contact surface", name, parts)
                part, load = parts[name], np.asarray(load, dtype=np.float64)
                if load.shape != part.shape:
                    raise InputError(
                        f"stress {self.name!r}: {what} forces on {name!r} must be {part.shape}, got {load.shape}"
                    )
                if np.any(load):
                    load = load.reshape(-1, *part.shape[-2:])
                    stress = stress + self._response(part, load) + part.of_traction(load)
        return stress

    def _of(self, what: str, fields: np.ndarray | None, given: np.ndarray) -> np.ndarray:
        """Sum of `fields` (N, p, 6) times `given` (N,); raises `InputError` for another number of them."""
        given = np.asarray(given, dtype=np.float64)
        count = 0 if fields is None else len(fields)
        if fields is None or given.shape != (count,):
            raise InputError(f"stress {self.name!r}: {what} must be ({count},), got {given.shape}")
        return np.tensordot(given.astype(fields.dtype), fields, axes=1).astype(np.float64)

    def _response(self, part: LoadStress, load: np.ndarray) -> np.ndarray:
        """T f (p, 6) in user axes."""
        N, amplitudes = part.transfer.sectors, part.amplitudes(load)
        if N == 1:
            return amplitudes[0][self.place]
        if len(self.points) > SUMMED * amplitudes.shape[1]:
            local = np.fft.irfft(amplitudes, n=N, axis=0)[self.sector, self.place]
        else:
            k = np.arange(len(amplitudes))
            weight = np.where((k == 0) | (2 * k == N), 1.0, 2.0) / N
            wave = weight * np.exp(2j * np.pi * (np.outer(self.sector, k) % N) / N)
            local = np.einsum("jh,hjc->jc", wave, amplitudes[:, self.place]).real
        return rotated(local, sector_frames(part.transfer.axes, self.sector, N))

    # --- plain arrays, for the body's file ---

    @property
    def _loads(self) -> dict[str, LoadStress]:
        """All loads by path."""
        return {
            **{f"normal/{name}": part for name, part in self.normal.items()},
            **{f"tangential/{name}": part for name, part in self.tangential.items()},
        }

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays of the field by path; `restore` reads them back."""
        found = {"points": self.points, "modes": self.modes, "place": self.place, "sector": self.sector}
        if self.matched is not None:
            found["matched"] = self.matched
        if self.membrane is not None:
            found["membrane"] = self.membrane
        for root, part in self._loads.items():
            own = {f"{root}/own/{key}": getattr(part.own, key) for key in ("data", "indices", "indptr")}
            found.update(own, **{f"{root}/transfer": part.transfer.transfer, f"{root}/axes": part.transfer.axes})
        return found

    def facts(self) -> dict[str, Any]:
        """The data other than arrays, as JSON."""
        return {
            root: {
                "transfer": [int(v) for v in (p.transfer.sectors, p.transfer.offset, p.transfer.stride)],
                "span": [int(p.span.first), int(p.span.columns), bool(p.span.closed)],
            }
            for root, p in self._loads.items()
        }

    @classmethod
    def restore(
        cls, name: str, arrays: dict[str, np.ndarray], facts: dict[str, Any], contact: dict[str, Any]
    ) -> StressField:
        """The field of `arrays()` and `facts()` on the body's contact surfaces."""
        from scipy.sparse import csr_matrix

        found: dict[str, dict[str, LoadStress]] = {"normal": {}, "tangential": {}}
        for root, f in facts.items():
            what, on = root.split("/", 1)
            (sectors, offset, stride), span = f["transfer"], GridSpan(*f["span"])
            transfer = Recovery(arrays[f"{root}/transfer"], sectors, arrays[f"{root}/axes"], offset, stride)
            part = LoadStress(contact[on], transfer, None, span, what == "tangential")
            functions = span.columns * part.grid.rows * (2 if part.tangential else 1)
            parts = tuple(arrays[f"{root}/own/{key}"] for key in ("data", "indices", "indptr"))
            own = csr_matrix(parts, shape=(6 * len(arrays["points"]), functions))
            found[what][on] = replace(part, own=own)
        return cls(
            name, arrays["points"], arrays["modes"], found["normal"], found["tangential"], arrays["place"],
            arrays["sector"], arrays.get("matched"), arrays.get("membrane"),
        )  # fmt: skip


Array = np.ndarray


def skin_strain(body: Any, q: Array) -> Array:
    """Strains (t, 3) [-] of the edges of each triangle of the skin of a flexible body at modal coordinates q (m,) [m].
    A *body* is any object with `reduced` and `stiffening`."""
    surface = body.reduced.surface
    corners = np.asarray(surface.triangles)

    def edges(x: Array) -> Array:
        at = np.asarray(x, dtype=float)[corners]
        return np.roll(at, -1, axis=1) - at  # (t, 3, 3)

    X = edges(surface.points)
    stretch = np.einsum("tei,tei->te", X, edges(skin_displacement(body, q)))
    if motion_of(body) is not None:
        stretch += 0.5 * np.sum(edges(np.tensordot(q, surface.modes, 1)) ** 2, axis=2)
    return stretch / np.sum(X * X, axis=2)
