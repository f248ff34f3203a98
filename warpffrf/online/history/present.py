"""The last rows of a run as what sensors see, made only as far as it is asked for.

Bodies and joints are evaluated one by one, everything else with the whole History of these rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any, Generic, TypeVar

import numpy as np

from warpffrf.model.bodies import Port
from warpffrf.model.joints import Joint, Marker
from warpffrf.model.rotation import cross
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.history.history import BodyHistory, History, JointHistory
from warpffrf.online.history.interface_motion import turned
from warpffrf.online.history.record import history_from_rows, joint_coordinates, reaction

Kind = TypeVar("Kind")


class OnRequest(Mapping[str, Kind], Generic[Kind]):
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


class _Motion:
    """A BodyHistory of body i each of whose arrays is made when it is asked for, as `record.user_frame` makes it."""

    def __init__(self, compiled: CompiledScene, rows: Mapping[str, np.ndarray], i: int) -> None:
        body, first = compiled.scene.bodies[i], compiled.modal_start[i]
        self._rows, self._i, self._center = rows, i, body.center_of_mass
        self._modes = slice(first, first + body.mode_count)

    def _body(self, name: str) -> np.ndarray:
        return self._rows[f"saved_{name}"][:, self._i]

    @cached_property
    def rotation(self) -> np.ndarray:
        return self._body("p").copy()

    @cached_property
    def angular_velocity(self) -> np.ndarray:
        return turned(self.rotation, self._body("omega"))

    @cached_property
    def angular_acceleration(self) -> np.ndarray:
        return turned(self.rotation, self._body("omega_rate"))

    @cached_property
    def _arm(self) -> np.ndarray:
        return turned(self.rotation, self._center)

    @cached_property
    def _swing(self) -> np.ndarray:
        return cross(self.angular_velocity, self._arm)

    @cached_property
    def position(self) -> np.ndarray:
        return self._body("r") - self._arm

    @cached_property
    def velocity(self) -> np.ndarray:
        return self._body("v") - self._swing

    @cached_property
    def acceleration(self) -> np.ndarray:
        turning = cross(self.angular_acceleration, self._arm)
        return self._body("v_rate") - turning - cross(self.angular_velocity, self._swing)

    @cached_property
    def modal(self) -> np.ndarray:
        return self._rows["saved_q"][:, self._modes].copy()

    @cached_property
    def modal_velocity(self) -> np.ndarray:
        return self._rows["saved_qd"][:, self._modes].copy()

    @cached_property
    def modal_acceleration(self) -> np.ndarray:
        return self._rows["saved_qd_rate"][:, self._modes].copy()


class _Reaction:
    """A JointHistory each of whose arrays is made when it is asked for, as `record.joint_history` makes it."""

    def __init__(self, run: Present, joint: Joint, frames: tuple[Marker, Marker] | None) -> None:
        self._run, self._joint, self._frames = run, joint, frames
        self.names = tuple(joint.coordinates)

    @cached_property
    def _both(self) -> tuple[np.ndarray, np.ndarray]:
        return joint_coordinates(self._run.compiled, self._run.rows, self._joint, self._run.bodies, self._frames)

    @cached_property
    def _wrench(self) -> np.ndarray:
        return reaction(self._run.compiled, self._run.rows, self._joint)

    coordinate = property(lambda self: self._both[0])
    second_coordinate = property(lambda self: self._both[1])
    force = property(lambda self: self._wrench[:, :3])
    torque = property(lambda self: self._wrench[:, 3:])

    def named(self, name: str) -> np.ndarray:
        """As of a JointHistory."""
        return JointHistory.named(self, name)  # type: ignore[arg-type]


class Present:
    """`rows` of a run, the last of which is the present, with the attributes of their History; `frames` of joints by
    name, if they are known."""

    def __init__(
        self,
        compiled: CompiledScene,
        rows: Mapping[str, np.ndarray],
        frames: Mapping[str, tuple[Marker, Marker]] | None = None,
    ) -> None:
        self.compiled, self.rows, self.scene = compiled, rows, compiled.scene
        self.time: np.ndarray = rows["saved_time"]
        scene = compiled.scene
        motions: Any = OnRequest([body.name for body in scene.bodies], lambda i: _Motion(compiled, rows, i))
        self.bodies: Mapping[str, BodyHistory] = motions
        reactions: Any = OnRequest(
            [str(joint.name) for joint in scene.joints],
            lambda i: _Reaction(self, scene.joints[i], (frames or {}).get(str(scene.joints[i].name))),
        )
        self.joints: Mapping[str, JointHistory] = reactions

    @cached_property
    def history(self) -> History:
        """The whole History."""
        return history_from_rows(self.compiled, dict(self.rows))

    def motion(self, port: Port, *, point: np.ndarray | None = None, frame: str = "world") -> Any:
        """As of a History."""
        return History.motion(self, port, point=point, frame=frame)  # type: ignore[arg-type]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.history, name)
