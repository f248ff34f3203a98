"""The program of a scene: all participants, in their order within a phase."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

from warpffrf.online.arrays.axes import Sizes
from warpffrf.online.arrays.declaration import Arrays, Bound
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.step import phases
from warpffrf.online.step.contact import CONTACT
from warpffrf.online.step.film import FILM, SECOND, WARM
from warpffrf.online.step.friction import FRICTION
from warpffrf.online.step.joint_friction import JOINT_FRICTION
from warpffrf.online.step.launches import Launch
from warpffrf.online.step.layers import LAYERS
from warpffrf.online.step.ledger import LEDGER
from warpffrf.online.step.lumped import LUMPED
from warpffrf.online.step.matched import MATCHED
from warpffrf.online.step.motion import MOTION
from warpffrf.online.step.pretension import PRETENSION
from warpffrf.online.step.retained import OUTER
from warpffrf.online.step.snapshot import SNAPSHOT

PARTICIPANTS = (
    MOTION, OUTER, JOINT_FRICTION, PRETENSION, LUMPED, SECOND, WARM, FILM, MATCHED, CONTACT, FRICTION, LAYERS,
    SNAPSHOT, LEDGER,
)  # fmt: skip
WHOLE = (*phases.ATTEMPT, *phases.ITERATION, *phases.DECISION)


class Program:
    """The launches of a scene on its arrays; `run` executes phases in order."""

    def __init__(
        self, compiled: CompiledScene, sizes: Sizes, owners: Sequence[Arrays], constants: dict[str, object]
    ) -> None:
        self.sizes, self.device = sizes, compiled.device
        arrays = {name: getattr(owner, name) for owner in owners for name in owner.declarations}
        self.arrays: Mapping[Any, Any] = Bound(arrays | constants)
        self.parts = {phase: phases.collect(PARTICIPANTS, phase) for phase in WHOLE}
        for launch in self.launches():  # allocates the topics: what is created during capture does not exist yet
            launch.arguments(self.arrays)

    def on(self, arrays: Mapping[Any, Any], sizes: Sizes) -> Program:
        """The same launches on other arrays, for a scene whose axes are the same except for the worlds."""
        found = copy.copy(self)
        found.arrays, found.sizes = arrays, sizes
        return found

    def run(self, names: Sequence[str]) -> None:
        """Launch these phases, or record them while a graph is being captured."""
        for name in names:
            phases.record(self.parts[name], self.arrays, self.sizes, self.device)

    def launches(self) -> list[Launch]:
        """All launches of the scene, to compile their modules."""
        return [launch for phase in WHOLE for launch, _ in phases.launches(self.parts[phase], self.sizes)]
