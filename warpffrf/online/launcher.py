"""What every part of the step graph has: the arrays of a run, and two ways to launch a kernel on them."""

from __future__ import annotations

from typing import Any

import warp as wp
from warpffrf_kernels.scalars import BLOCK

from warpffrf.online.compile import CompiledScene
from warpffrf.online.state import State, Work


class Launcher:
    """The constants, state and scratch arrays of `worlds` copies of a scene."""

    def __init__(self, compiled: CompiledScene, state: State, work: Work, worlds: int) -> None:
        self.compiled, self.state, self.work, self.worlds = compiled, state, work, worlds
        self.device = compiled.device

    def launch(self, kernel: Any, dim: Any, inputs: list, outputs: list) -> None:
        """One thread per index."""
        wp.launch(kernel, dim=dim, inputs=inputs, outputs=outputs, device=self.device)

    def block(self, kernel: Any, dim: Any, inputs: list, outputs: list) -> None:
        """One block of lanes per index."""
        wp.launch_tiled(kernel, dim=dim, inputs=inputs, outputs=outputs, block_dim=BLOCK, device=self.device)
