"""Scene -> device arrays -> step graph -> History."""

from warpffrf.model.integrators import HHT, INTEGRATORS, EnergyMomentum, GeneralizedAlpha, Newmark, RungeKutta4
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.local_modes import LocalModes
from warpffrf.online.run import find_equilibrium, run
from warpffrf.online.settings import Settings
from warpffrf.online.warp_lock import WARP_LOCK

__all__ = [
    "HHT",
    "INTEGRATORS",
    "WARP_LOCK",
    "Engine",
    "EnergyMomentum",
    "GeneralizedAlpha",
    "History",
    "LocalModes",
    "Newmark",
    "RungeKutta4",
    "Settings",
    "find_equilibrium",
    "run",
]
