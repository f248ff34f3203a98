"""Scene -> device arrays -> step graph -> History."""

from warpffrf.online.engine import Engine
from warpffrf.online.generalized_alpha import GeneralizedAlpha
from warpffrf.online.history import History
from warpffrf.online.run import find_equilibrium, run
from warpffrf.online.settings import Settings

__all__ = ["Engine", "GeneralizedAlpha", "History", "Settings", "find_equilibrium", "run"]
