"""Where joints and forces act: places on bodies that pictures need besides the motion of the bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.reduced.interface_motion import interface_motion


@dataclass(frozen=True, eq=False)
class Anchor:
    """A place where a joint or a force element holds a body.

    kind: "joint" or "force"; name: of the joint or element; body: its name, None for the ground; interface: the name of
    the interface whose deformation it follows, or None; point (3,) [m, user frame, world for the ground]; loaded: the
    recorded force acts here (on a joint's or spring's second side), its opposite on the other side.
    """

    kind: str
    name: str
    body: str | None
    interface: str | None
    point: np.ndarray
    loaded: bool

    def describe(self) -> list[Any]:
        """Plain data for a results file; `Anchor.of` reads it."""
        return [self.kind, self.name, self.body, self.interface, [float(x) for x in self.point], self.loaded]

    @classmethod
    def of(cls, data: list[Any]) -> Anchor:
        """The anchor that `describe` gave."""
        kind, name, body, interface, point, loaded = data
        return cls(kind, name, body, interface, np.array(point, dtype=float), bool(loaded))

    def local(self, body: Any, modal: np.ndarray, factor: float) -> np.ndarray:
        """The place (3,) [m, user frame] on `body`, its `BodyView`, with the interface's motion times `factor` at modal
        coordinates (m,)."""
        if self.interface is None or body.reduced is None or not len(modal):
            return self.point
        motion = factor * interface_motion(body, self.interface, modal)
        arm = self.point - body.reduced.interfaces[self.interface].point
        return self.point + motion[:3] + np.cross(motion[3:], arm)


def scene_anchors(scene: Any) -> tuple[Anchor, ...]:
    """Anchors of the joints and forces of a live `Scene`, from its initial pose."""
    found = [anchor for joint in scene.joints for anchor in _sides("joint", joint.name, joint.ports, joint.frames())]
    for force in scene.forces:
        joint = getattr(force, "joint", None)
        if joint is not None:
            found += _sides("force", force.name, joint.ports, joint.frames())
            continue
        ports = [port for port in force.ports if getattr(port, "point", None) is not None]
        at = force.world_point() if hasattr(force, "world_point") else None  # elements whose two sides meet in a point
        for n, port in enumerate(ports):
            point = port.point if at is None else port.body.to_user(at)
            found.append(_anchor("force", force.name, port, point, n == len(ports) - 1))
    return tuple(found)


def _sides(kind: str, name: str, ports: Any, frames: Any) -> list[Anchor]:
    return [_anchor(kind, name, p, f.point, n == 1) for n, (p, f) in enumerate(zip(ports, frames, strict=True))]


def _anchor(kind: str, name: str, port: Any, point: np.ndarray, loaded: bool) -> Anchor:
    body = None if port.body.index < 0 else port.body.name
    return Anchor(kind, name, body, port.interface_name, np.array(point, dtype=float), loaded)
