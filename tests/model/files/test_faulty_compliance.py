"""Files of reduced bodies whose compliance no body has: refused by name, with the place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError


@pytest.fixture(scope="module")
def body() -> wf.ReducedBody:
    mesh = wf.mesh.roller(0.05, 0.02, 0.02, sectors=12, layers=1, axial=2, order=1)
    return wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7850.0), contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(tangential=True), cache=False, progress=False,
    )  # fmt: skip


def own(lags: np.ndarray, line: int, value: float) -> np.ndarray:
    """`lags` with another displacement of a line by its own force."""
    changed = lags.copy()
    changed[0, line, line] = value
    return changed


def apart(lags: np.ndarray, factor: float) -> np.ndarray:
    """`lags` in which the first two lines of a sector displace each other by `factor` times their own."""
    changed = lags.copy()
    changed[0, 0, 1] = changed[0, 1, 0] = factor * lags[0, 0, 0]
    return changed


WRONG = {
    "rim/lags is not symmetric: column 0, row 0 and column 0, row 1": lambda n, t: (n * (1.0 + 1e-9 * edge(n)), t),
    "rim/lags is not positive definite: column 0, row 2 moves against": lambda n, t: (own(n, 2, -1e-12), t),
    "rim/lags is not positive definite: column 0, row 0 moves more by column 0, row 1": lambda n, t: (apart(n, 1.5), t),
    "lags_tt is not positive definite: direction 1, column 0, row 1": lambda n, t: (n, own(t, len(t[0]) // 2 + 1, 0.0)),
    "lags holds NaN or infinite numbers": lambda n, t: (own(n, 1, np.nan), t),
}


def edge(lags: np.ndarray) -> np.ndarray:
    """1 where line 1 loads line 0 of the same sector."""
    found = np.zeros_like(lags)
    found[0, 0, 1] = 1.0
    return found


@pytest.mark.parametrize("says", WRONG)
def test_it_is_refused(body: wf.ReducedBody, tmp_path: Path, says: str) -> None:
    rim: Any = body.contact_surfaces["rim"]
    lags, tangential = WRONG[says](rim.lags, rim.tangential.lags_tt)
    rim = replace(rim, lags=lags, tangential=replace(rim.tangential, lags_tt=tangential))
    path = replace(body, contact_surfaces={"rim": rim}).save(tmp_path / "wrong.h5")
    with pytest.raises(InputError, match=says):
        wf.ReducedBody.load(path)
