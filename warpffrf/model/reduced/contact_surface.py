r"""`ContactSurface`: what of a reduced body's contact surface the simulation needs.

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

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.half_space.far_splines import FarSplines
from warpffrf.model.reduced.contact_grid import ContactGrid
from warpffrf.model.reduced.far_field import FarField
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.model.reduced.recovery import Recovery
from warpffrf.model.reduced.sampling import Sampling
from warpffrf.model.reduced.tangential import Tangential


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
    local_mass: LocalMass | None = None  # inertia of the local modes, see `warpffrf.model.reduced.local_modes`
    sampling: Sampling | None = (
        None  # few points for all, see `warpffrf.model.reduced.sampling`; None: none were chosen
    )
    slope_lags: np.ndarray | None = (
        None  # what D gains where normals lean, `warpffrf.model.reduced.slopes`; None: stiff bodies
    )
    far: FarField | None = (
        None  # for patches finer than the mesh, see `warpffrf.model.reduced.far_field`; None: not computed
    )

    @property
    def local_modes(self) -> int:
        """Number of normal local modes: one a hat."""
        return self.grid.columns * self.grid.rows

    @cached_property
    def splines(self) -> FarSplines:
        """The splines of the far field, with what takes hats to them."""
        return FarSplines(self.grid, self.shape, self._turn)

    @cached_property
    def tangential_splines(self) -> FarSplines:
        """The same splines, with what takes the functions of tangential tractions to them. Raises `TypeError` without
        any."""
        if self.tangential is None:
            raise TypeError(f"contact surface {self.name!r} has no tangential tractions")
        return FarSplines(self.tangential.grid, self.shape, self._turn)

    @cached_property
    def mode_tangent_splines(self) -> np.ndarray:
        """Tangential displacement of the global modes (2, columns rows, m) [m per unit modal coordinate], splines.
        Raises `TypeError` without tangential tractions."""
        splines = self.tangential_splines
        assert self.tangential is not None
        return np.stack([splines.of_functions(modes) for modes in self.tangential.mode_tangent])

    @property
    def _turn(self) -> int:
        """Columns of the full turn that the grid is part of, 0 of none."""
        turning = len(self.lags) > 1 or self.grid.periodic
        return len(self.lags) * self.grid.columns_per_sector if turning else 0

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
