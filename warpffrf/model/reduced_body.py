r"""`ReducedBody`: what the offline reduction hands to the simulation.

Symbols: `Phi_g` global modes with coordinates `q_g`, `psi_i` hats of a contact grid, `n` outward normal of the true
surface. The elastic displacement of a body is

    u = Phi_g q_g + (local part driven by the contact load)

and on a contact surface, as hat coefficients of the outward normal displacement (L2 projection with the hat Gram
matrix `M`),

    u_n = mode_normal q_g + D f,      f_i = int psi_i p dA   (outward hat forces, N),      D = M^-1 C M^-1.

On a body of N equal sectors `D` couples sectors by their distance only (block-circulant), so one block row is stored:
`D[(j,k),(j',k')] = lags[(j//c - j'//c) mod N][(j%c) rows + k, (j'%c) rows + k']`, `c` grid columns per sector.
"""

from __future__ import annotations

import importlib.metadata
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

GAUSS_PER_ROW = 6  # points between two grid rows: a crown's measure is not polynomial, six points leave 1e-14 of it


@dataclass(frozen=True, eq=False)
class ContactGrid:
    """A grid of hats over the chart (theta, z) of a surface of revolution.

    Node (j, k) lies at `theta_start + j*pitch`, `z[k]`; its flat index is `j*rows + k`. The hat of a node is the
    product of two linear hats. `periodic`: the columns close around the full turn; otherwise the hats stand on an
    arc, and all of their supports lie inside the contact surface.
    """

    e_0: np.ndarray  # (3,) direction of theta = 0, user axes
    theta_start: float  # rad
    pitch: float  # rad
    columns: int
    periodic: bool
    z: np.ndarray  # (rows,) m, ascending
    columns_per_sector: int

    @property
    def rows(self) -> int:
        """Number of axial grid nodes."""
        return len(self.z)

    @property
    def theta(self) -> np.ndarray:
        """Angles of the columns (columns,) [rad]."""
        return self.theta_start + self.pitch * np.arange(self.columns)

    def gram_theta(self) -> np.ndarray:
        """M_theta (columns, columns) [rad]: int psi_j psi_j' dtheta, tridiagonal or circulant."""
        n = self.columns
        M = np.zeros((n, n))
        j = np.arange(n)
        M[j, j] = 2.0 / 3.0 * self.pitch
        if self.periodic:
            np.add.at(M, (j, (j + 1) % n), self.pitch / 6.0)
            np.add.at(M, ((j + 1) % n, j), self.pitch / 6.0)
        else:
            M[j[:-1], j[1:]] = M[j[1:], j[:-1]] = self.pitch / 6.0
        return M


def axial_gram(shape: Any, z: np.ndarray) -> np.ndarray:
    """M_z (rows, rows) [m^2/rad]: int psi_k psi_k' R(z) sqrt(1 + R'(z)^2) dz for the axial hats on the nodes `z` [m].

    `shape` is a resolved surface of revolution (`radius_at`, `slope_at`). The hat Gram matrix of the surface is
    `M = M_theta (x) M_z` [m^2], `M f`: hat coefficients of a traction to hat forces.
    """
    rows = len(z)
    x, w = np.polynomial.legendre.leggauss(GAUSS_PER_ROW)
    s = 0.5 * (x + 1.0)
    step = np.diff(z)
    points = z[:-1, None] + step[:, None] * s
    measure = 0.5 * step[:, None] * w * shape.radius_at(points) * np.sqrt(1.0 + shape.slope_at(points) ** 2)
    hats = np.stack([1.0 - s, s])
    M = np.zeros((rows, rows))
    local = np.einsum("aq,bq,eq->eab", hats, hats, measure)
    for a in range(2):
        for b in range(2):
            np.add.at(M, (np.arange(rows - 1) + a, np.arange(rows - 1) + b), local[:, a, b])
    return M


@dataclass(frozen=True, eq=False)
class Recovery:
    """Displacement of the display points under hat forces: block-circulant, applied by FFT over the sectors.

    `transfer` (N//2 + 1, 3 p, c rows) complex64: displacement of one sector's `p` display points, in that sector's own
    axes, per harmonic amplitude of the hat forces. `axes` (3, 3): columns are the axes of sector 0 in user axes, the
    third is the axis of rotation. A body without periodicity has one sector and a real transfer (1, 3 n, hats).
    Grid column j is column `offset + j*stride` of the `c*N` columns that the harmonics count.
    """

    transfer: np.ndarray
    sectors: int
    axes: np.ndarray
    offset: int = 0
    stride: int = 1

    def apply(self, forces: np.ndarray, columns_per_sector: int) -> np.ndarray:
        """Displacement (n, 3) [m], user axes, of hat forces (columns, rows) [N]."""
        N = self.sectors
        columns, rows = forces.shape
        whole = np.zeros((columns_per_sector * N, rows)) if N > 1 else np.zeros((columns, rows))
        whole[(self.offset + self.stride * np.arange(columns)) % len(whole)] = forces
        blocks = whole.reshape(N, -1)
        if N == 1:
            return (self.transfer[0] @ blocks[0].astype(self.transfer.dtype)).reshape(-1, 3).astype(np.float64)
        amplitudes = np.fft.rfft(blocks, axis=0)
        response = np.einsum("hpi,hi->hp", self.transfer, amplitudes)
        u = np.fft.irfft(response, n=N, axis=0).reshape(N, -1, 3)
        return sector_to_user(u, self.axes)


def sector_to_user(u: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Vectors (N, p, 3) given in the axes of their own sectors -> (N p, 3) in user axes.

    Sector s is sector 0 turned by `2 pi s/N` about the third of `axes` (3, 3, columns = axes of sector 0).
    """
    N = len(u)
    angle = 2.0 * np.pi * np.arange(N)[:, None] / N
    c, s = np.cos(angle), np.sin(angle)
    turned = np.stack([c * u[..., 0] - s * u[..., 1], s * u[..., 0] + c * u[..., 1], u[..., 2]], axis=-1)
    return turned.reshape(-1, 3) @ axes.T


@dataclass(frozen=True, eq=False)
class ContactSurface:
    """A contact surface of a reduced body: its true shape, its hats, and their normal compliance (module docstring)."""

    name: str
    shape: Any  # resolved surface of revolution, see `warpffrf.model.surfaces`
    grid: ContactGrid
    lags: np.ndarray  # (sectors, c rows, c rows) m/N
    mode_normal: np.ndarray  # (columns rows, m) m per unit modal coordinate
    recovery: Recovery

    @property
    def local_modes(self) -> int:
        """Number of normal local modes: one a hat."""
        return self.grid.columns * self.grid.rows

    @cached_property
    def gram_z(self) -> np.ndarray:
        """M_z (rows, rows) [m^2/rad], see `axial_gram`."""
        return axial_gram(self.shape, self.grid.z)

    def recover(self, forces: np.ndarray) -> np.ndarray:
        """Local displacement (n, 3) [m], user axes, of the display surface's points under outward hat forces
        (columns, rows) [N]. Global modes are not included."""
        return self.recovery.apply(np.asarray(forces, dtype=np.float64), self.grid.columns_per_sector)

    def compliance(self, columns: np.ndarray) -> np.ndarray:
        """D (w rows, w rows) [m/N] of the hats of the given grid `columns` (w,)."""
        c, rows = self.grid.columns_per_sector, self.grid.rows
        sector, part = columns // c, columns % c
        lag = (sector[:, None] - sector[None, :]) % len(self.lags)
        blocks = self.lags.reshape(len(self.lags), c, rows, c, rows)
        D = blocks[lag, part[:, None], :, part[None, :], :]
        return D.transpose(0, 2, 1, 3).reshape(len(columns) * rows, -1)


@dataclass(frozen=True, eq=False)
class Interface:
    """A rigid interface: `modes` (m, 6) is translation [m] and rotation [rad] at `point` (3,) [m] per unit modal
    coordinate, user axes. Local modes do not move it."""

    kind: str
    point: np.ndarray
    modes: np.ndarray


@dataclass(frozen=True, eq=False)
class DisplaySurface:
    """Outer skin for pictures: points (n, 3) [m, user frame], triangles (t, 3), modes (m, n, 3)."""

    points: np.ndarray
    triangles: np.ndarray
    modes: np.ndarray


@dataclass(frozen=True, eq=False)
class ReducedBody:
    """A flexible body, reduced: mass properties, global modes, interfaces, contact surfaces, skin, and how it was made.

    Modes are M-orthonormal (modal mass 1 kg), K-orthogonal and M-orthogonal to rigid motion (Tisserand frame).
    """

    mass: float  # kg
    center_of_mass: np.ndarray  # (3,) m, user frame
    inertia: np.ndarray  # (3, 3) kg m2, about the centre of mass, user axes
    frequencies: np.ndarray  # (m,) Hz, ascending
    interfaces: dict[str, Interface]
    contact_surfaces: dict[str, ContactSurface]
    surface: DisplaySurface
    report: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def local_modes(self) -> int:
        """Normal local modes of all contact surfaces."""
        return sum(s.local_modes for s in self.contact_surfaces.values())

    def save(self, path: str | Path) -> Path:
        """Write one HDF5 file; returns its path. Raises `InputError` where it cannot be written."""
        from warpffrf.model.reduced_body_file import write_reduced_body

        return write_reduced_body(self, Path(path))

    @classmethod
    def load(cls, path: str | Path) -> ReducedBody:
        """Read a file of `save`. Raises `InputError` for a missing, damaged, or newer-schema file."""
        from warpffrf.model.reduced_body_file import read_reduced_body

        return read_reduced_body(Path(path))

    def content_hash(self) -> str:
        """sha256 over all arrays (not over report and provenance)."""
        from warpffrf.model.reduced_body_file import content_hash

        return content_hash(self)

    def info(self) -> str:
        """Readable summary."""
        f = self.frequencies
        x, y, z = self.center_of_mass
        lines = [
            f"reduced body {self.provenance.get('mesh_name') or '(unnamed)'}",
            f"  mass            {self.mass:.6g} kg, centre ({x:.6g}, {y:.6g}, {z:.6g}) m",
            "  inertia         " + ", ".join(f"{v:.6g}" for v in np.diag(self.inertia)) + " kg m2 (diagonal)",
            f"  global modes    {len(f)}" + (f", {f[0]:.6g} to {f[-1]:.6g} Hz" if len(f) else ""),
            f"  local modes     {self.local_modes} (normal)",
        ]
        for name, i in self.interfaces.items():
            lines.append(f"  interface       {name}: {i.kind}, at ({', '.join(f'{v:.6g}' for v in i.point)}) m")
        for name, s in self.contact_surfaces.items():
            g = s.grid
            extent = "full turn" if g.periodic else f"arc of {np.degrees(g.pitch * (g.columns + 1)):.4g} degrees"
            lines.append(
                f"  contact surface {name}: {type(s.shape).__name__}, {g.columns} x {g.rows} hats on a {extent}, "
                f"compliance {'block-circulant' if len(s.lags) > 1 else 'dense'}, {s.lags.nbytes / 2**20:.3g} MiB"
            )
        lines.append(f"  skin            {len(self.surface.points)} points, {len(self.surface.triangles)} triangles")
        for key, label in (("path", "path"), ("path_reason", "because"), ("dofs", "FE dofs"), ("seconds", "seconds")):
            if key in self.report:
                value = self.report[key]
                lines.append(f"  {label:<15} {value:.3g}" if isinstance(value, float) else f"  {label:<15} {value}")
        for key in ("notes", "warnings"):
            lines.extend(f"  {key[:-1]}: {text}" for text in self.report.get(key, []))
        if digest := self.provenance.get("content_hash"):
            lines.append(f"  content hash    {digest[:16]}")
        return "\n".join(lines)


def library_versions(names: tuple[str, ...]) -> dict[str, str]:
    """Versions of installed distributions, for provenance; 'not installed' where there is none."""
    found = {}
    for name in names:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found
