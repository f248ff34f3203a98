"""The last rows of a run as what sensors see, made only as far as it is asked for.

Bodies and joints are evaluated one by one, everything else with the whole History of these rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any, Generic, TypeVar

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.history.history import BodyHistory, History, JointHistory
from warpffrf.online.history.record import body_history, history_from_rows, joint_history

Kind = TypeVar("Kind")


class _OnRequest(Mapping[str, Kind], Generic[Kind]):
    """Values by name, each made when it is first asked for."""

    def __init__(self, names: Iterable[str], make: Callable[[int], Kind]) -> None:
        self._place, self._make = {name: i for i, name in enumerate(names)}, make
        self._made: dict[str, Kind] = {}

    def __getitem__(self, name: str) -> Kind:
        if name not in self._made:
            self._made[name] = self._make(self._place[name])
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._place

    def __iter__(self) -> Iterator[str]:
        return iter(self._place)

    def __len__(self) -> int:
        return len(self._place)


class Present:
    """`rows` of a run, the last of which is the present, with the attributes of their History."""

    def __init__(self, compiled: CompiledScene, rows: SavedRows) -> None:
        self.compiled, self.rows, self.scene = compiled, rows, compiled.scene
        self.time: np.ndarray = rows["saved_time"]
        scene = compiled.scene
        self.bodies: Mapping[str, BodyHistory] = _OnRequest(
            [body.name for body in scene.bodies], lambda i: body_history(compiled, rows, i)
        )
        self.joints: Mapping[str, JointHistory] = _OnRequest(
            [str(joint.name) for joint in scene.joints],
            lambda i: joint_history(compiled, rows, scene.joints[i], self.bodies),
        )

    @cached_property
    def history(self) -> History:
        """The whole History."""
        return history_from_rows(self.compiled, self.rows)

    def motion(self, port: Port, *, point: np.ndarray | None = None, frame: str = "world") -> Any:
        """As of a History."""
        return History.motion(self, port, point=point, frame=frame)  # type: ignore[arg-type]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.history, name)
