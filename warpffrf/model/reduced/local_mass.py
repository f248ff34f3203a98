"""Inertia of the local modes of a contact surface; used in `local_modes`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class LocalMass:
    """Inertia of the local modes of a contact surface: N and W of `local_modes`.

    `lags_mass` (L, c rows, c rows) [m^2 kg/N^2]: N in the layout of `ContactSurface.lags`. `overlap` (L c rows, m)
    [m kg/N]: W^T, rows numbered by column and row; on an arc of a periodic body those of the full revolution from the
    arc's column 0 on.
    """

    lags_mass: np.ndarray
    overlap: np.ndarray
