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

import importlib
import importlib.metadata
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.contact_grid import ContactGrid
from warpffrf.model.inertia import InertiaTerms
from warpffrf.model.tangential import Tangential

if TYPE_CHECKING:
    from warpffrf.model.local_modes import LocalMass
    from warpffrf.model.sampling import Sampling
    from warpffrf.model.stress_field import StressField


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
    tangential: Tangential | None = None
    local_mass: LocalMass | None = None  # inertia of the local modes, see `warpffrf.model.local_modes`
    sampling: Sampling | None = None  # few points for all, see `warpffrf.model.sampling`; None: none were chosen
    slope_lags: np.ndarray | None = None  # what D gains where normals lean, `warpffrf.model.slopes`; None: stiff bodies

    @property
    def local_modes(self) -> int:
        """Number of normal local modes: one a hat."""
        return self.grid.columns * self.grid.rows

    @cached_property
    def gram_z(self) -> np.ndarray:
        """M_z (rows, rows) [m^2/rad], see `meridian_gram`."""
        return self.grid.gram_z(self.shape)

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
    """An interface of kind "rigid", "average" or "free": `modes` (m, 6) is its translation [m] and rotation [rad] at
    `point` (3,) [m] per unit modal coordinate, user axes; of the last two kinds the mean motion of its nodes.

    Local modes do not move it. A free one keeps its `nodes` (k, 3) [m], places in the user frame, and their
    displacement `node_modes` (m, k, 3) [m]; local modes move none of them either.
    """

    kind: str
    point: np.ndarray
    modes: np.ndarray
    nodes: np.ndarray | None = None
    node_modes: np.ndarray | None = None


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
    stress: dict[str, StressField] = field(default_factory=dict)  # where stresses can be asked for, by name
    report: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    inertia_terms: InertiaTerms | None = None  # of the first modes; None: of a body reduced before they existed

    def __repr__(self) -> str:
        """One line; the arrays by the thousand are for `info` to sum up."""
        found = [f"{self.mass:.5g} kg", f"{len(self.frequencies)} global modes", f"{self.local_modes} local modes"]
        named = {"interfaces": self.interfaces, "contact": self.contact_surfaces, "stress": self.stress}
        found += [f"{what} {', '.join(names)}" for what, names in named.items() if names]
        return f"<ReducedBody {'; '.join(found)}>"

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
        """Readable summary with the quality report."""
        from warpffrf.model.body_summary import summary

        return summary(self)

    def quality_page(self, path: str | Path) -> Path:
        """Write a picture of the body's quality: mode shapes, compliance decay, frequencies covered, key figures.

        The ending of `path` chooses the format (.png, .pdf, .svg). Raises `InputError` where it cannot be written.
        """
        return _output("plots.quality_page").write_quality_page(self, path)

    def show(
        self,
        mode: int | None = None,
        *,
        path: str | Path | None = None,
        frames: int = 60,
        scale: float | None = None,
    ) -> Any:
        """Animate a mode in rerun: in its viewer, or written to `path` (.rrd), which `rerun FILE` opens.

        Modes are numbered as finite-element programs number those of a free body: 1 to 6 are the rigid motions, 7 is
        the first elastic mode. None: the elastic modes one after the other, one cycle each. `frames`: pictures a
        cycle. `scale`: largest displacement drawn, as a part of the body's largest extent. Returns what was shown, see
        `warpffrf.output.recording.show.ShownModes`. Raises `InputError` for a mode that the body does not have.
        """
        return _output("recording.show").show_modes(self, mode, path=path, frames=frames, scale=scale)


def _output(module: str) -> Any:
    """A module of the output package. It imports the model, not the other way round: a method that draws finds it by
    name when it is called, so that the model depends on no viewer."""
    return importlib.import_module(f"warpffrf.output.{module}")


def library_versions(names: tuple[str, ...]) -> dict[str, str]:
    """Versions of installed distributions, for provenance; 'not installed' where there is none."""
    found = {}
    for name in names:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found
