"""The rigid mechanism of the engine of `connecting_rod` and `piston`, and the script that made its data."""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from demos.connecting_rod import CRANK, ROD, SPEED

FOLDER = Path(__file__).resolve().parents[2] / "demos" / "data"


def _script() -> Any:
    spec = importlib.util.spec_from_file_location("make_engine", FOLDER / "make_engine.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


make = _script()  # `rod_mesh`, `piston_mesh`, `gas_force` and the dimensions that they have


@dataclass(frozen=True)
class Mechanism:
    """Rigid motion at crank angles (T,) [rad]: pin (T, 2) [m], its acceleration; along (T, 2), lean [rad], rate
    [rad/s] and acceleration of the rod; piston (T,) [m] and its acceleration. Components x, z."""

    pin: np.ndarray
    pin_acceleration: np.ndarray
    along: np.ndarray
    lean: np.ndarray
    rate: np.ndarray
    turning: np.ndarray
    piston: np.ndarray
    piston_acceleration: np.ndarray

    @classmethod
    def at(cls, theta: Any) -> Mechanism:
        """Of r sin(theta) + l sin(phi) = 0, differentiated twice."""
        c, s, k = np.cos(theta), np.sin(theta), CRANK / ROD
        S = -k * s
        C = np.sqrt(1.0 - S**2)
        rate = -k * c * SPEED / C
        turning = (k * s * SPEED**2 + S * rate**2) / C
        pin = CRANK * np.stack([c, s], axis=-1)
        return cls(
            pin, -(SPEED**2) * pin, np.stack([C, S], axis=-1), np.arcsin(S), rate, turning, CRANK * c + ROD * C,
            -(SPEED**2) * CRANK * c - ROD * (S * turning + C * rate**2),
        )  # fmt: skip

    def in_rod(self, vectors: np.ndarray) -> np.ndarray:
        """World components (T, 2) as those along the rod and across it."""
        u = self.along
        return np.stack([np.sum(u * vectors, axis=1), cross(u, vectors)], axis=1)


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
