"""Revolutions of joints, counted over a run that is stepped.

The coordinate of a joint in a History is counted over its rows (`history.record`). Step by step it is counted over the
rows since the last count, so that the coordinate of a joint costs two rows, and over all rows when it is first read.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from warpffrf.model.joints import Joint, Marker
from warpffrf.online.history.history import JointHistory
from warpffrf.online.history.present import OnRequest, Present
from warpffrf.online.stepping import Stepping

TURN = 2.0 * np.pi


class Turns:
    """Counted coordinates of joints, `first`: at the first row of the run, by name (2,) [rad or m]."""

    def __init__(self, first: Mapping[str, np.ndarray] | None = None) -> None:
        self._first = dict(first or {})
        self._of: object = None  # the run that the counts are of
        self._at = 0  # the row that they are of
        self._counted: dict[str, np.ndarray] = {}
        self._frames: dict[str, tuple[Marker, Marker]] = {}  # of joints, and places of angles to count
        self._places: dict[str, list[int]] = {}

    @property
    def counting(self) -> bool:
        """Whether any joint is counted."""
        return bool(self._counted)

    def present(self, stepping: Stepping) -> Present:
        """The rows since the last count, with counted coordinates."""
        if self._of is not stepping.running:
            self._of, self._counted = stepping.running, {}
        rows, last = stepping.rows(self._at)
        run = Present(stepping.engine.compiled, rows, self._frames)
        joints, names = run.joints, list(run.joints)
        run.joints = OnRequest(names, lambda i: self._count(stepping, joints[names[i]], names[i]))
        known = list(self._counted)
        self._begins = last + 1 - len(rows["saved_time"]) == self._at
        for name in known:
            _ = run.joints[name]
        self._at = last
        return run

    def counts(self, run: Present) -> dict[str, np.ndarray]:
        """Counted coordinates of all joints at the present."""
        return {name: _last(run.joints[name]) for name in run.joints}

    def _count(self, stepping: Stepping, found: JointHistory, name: str) -> JointHistory:
        """`found` with whole turns added to its coordinates."""
        if name not in self._frames:
            joint = stepping.scene.joint(name)
            self._frames[name], self._places[name] = joint.frames(), _turning(stepping, joint)
        places = self._places[name]
        if not places:
            return found
        known = self._counted.get(name) if self._begins else None
        if known is None:
            whole = Present(stepping.engine.compiled, stepping.all_rows()).joints[name]
            first = self._first.get(name)
            _shift(whole, places, 0, first if first is not None else _first(whole))
            _shift(found, places, -1, _last(whole))
        else:
            _shift(found, places, 0, known)
        self._counted[name] = _last(found)
        return found


def _turning(stepping: Stepping, joint: Joint) -> list[int]:
    """Places of the angles of a joint that no drive prescribes."""
    driven = {d.coordinate for d in stepping.scene.drives if d.joint is joint}
    named = list(joint.coordinates.items())[:2]
    return [i for i, (name, row) in enumerate(named) if not row.is_length and name not in driven]


def _both(found: JointHistory) -> tuple[np.ndarray, np.ndarray]:
    return found.coordinate, np.asarray(found.second_coordinate)


def _first(found: JointHistory) -> np.ndarray:
    return np.array([values[0] for values in _both(found)])


def _last(found: JointHistory) -> np.ndarray:
    return np.array([values[-1] for values in _both(found)])


def _shift(found: JointHistory, places: list[int], row: int, to: np.ndarray) -> None:
    """Add the turns with which the coordinates are nearest to those of `to` in a row."""
    for i in places:
        values = _both(found)[i]
        values += TURN * np.round((to[i] - values[row]) / TURN)
