"""The arrays of a run, each declared once; allocation, checkpoints, launches and docs tables use the declarations."""

from warpffrf.online.arrays.axes import Sizes, sizes_of
from warpffrf.online.arrays.ring import Ring
from warpffrf.online.arrays.scratch import Scratch
from warpffrf.online.arrays.state import State, initial_motion, initial_state

__all__ = ["Ring", "Scratch", "Sizes", "State", "initial_motion", "initial_state", "sizes_of"]
