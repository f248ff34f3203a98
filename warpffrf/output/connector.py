r"""A scene as a function for an outside solver: motions in, forces out (`Connector`).

A body of the scene, such as the journal of a bearing, is held by driven joints whose signals are `signals.Input`s. The
outside solver has the equations of the rest of the machine, of a rotor

    m x'' = f(x, history) + p(t),

and integrates them with the forces f that the scene returns for positions x at the end of a step; rates within the
scene, as that of the gap of a film, are those of positions over steps. With differences of the second order, which damp
what a step does not resolve,

    x_(n+1) = (4 x_n - x_(n-1))/3 + 2h/3 v_(n+1),      v_(n+1) = (4 v_n - v_(n-1))/3 + 2h/3m (f + p)_(n+1),

one step is one equation r(x) = x - b - (2h/3)^2/m (f(x) + p_(n+1)) = 0, b of the past, for which Newton has the tangent
df/dx by differences. Each trial is the same step from the same state, so that the history, of a film with cavities or
of friction, is that of accepted steps only. (The trapezoidal rule outside does not damp: a film is stiffer than a step
resolves, and forces then alternate from step to step.)

Drives of quantity "velocity" integrate their inputs exactly: x_(n+1) = x_n + h/2 (v_n + v_(n+1)).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from warpffrf.model.errors import InputError, RunError, require_array, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.status import Status
from warpffrf.output.simulation import Simulation


@named_arguments
class Connector:
    """The next step of a `Simulation` as a function of inputs at its end, for an outside solver.

    inputs: names of the inputs that are its arguments; outputs: names of sensors and histories, as of
    `Simulation.outputs`, that are its values, one after the other with all their components. `connector(values)` may be
    called as often as the solver needs; only `accept()` moves on. While one is in use, only it may step the simulation;
    an input that changes has to be one of `inputs`. Raises `InputError` for unknown names and values that are no finite
    numbers, `RunError` for a step that fails, after which another one may be tried.

    >>> speed = wf.signals.Input("speed", unit="m/s")
    >>> rig = wf.Scene()
    >>> piston = rig.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="piston")
    >>> guide = rig.add(wf.joints.Prismatic(rig.ground, piston, axis=(0, 0, 1), name="guide"))
    >>> _ = rig.add(wf.joints.Drive(guide, speed, quantity="velocity"))
    >>> _ = rig.add(wf.forces.JointSpringDamper(guide, stiffness=1e3, damping=10.0, name="spring"))
    >>> spring = wf.Connector(wf.Simulation(rig, step=1e-3), inputs=["speed"], outputs=["joint_coordinate[guide]"])
    >>> [round(float(spring([v])[0]), 6) for v in (1.0, 3.0)]  # two trials of one step
    [0.0005, 0.0015]
    """

    def __init__(self, simulation: Simulation, *, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        if not isinstance(simulation, Simulation):
            raise InputError(f"Connector: simulation must be a Simulation, got {simulation!r}")
        for kind, names in (("inputs", inputs), ("outputs", outputs)):
            if isinstance(names, str) or not names:
                raise InputError(f"Connector: {kind} must be a list of at least one name, got {names!r}")
        for name in inputs:
            if name not in simulation.inputs:
                raise unknown_name("Connector: input", name, simulation.inputs)
        self.simulation, self._inputs, self._outputs = simulation, tuple(inputs), tuple(outputs)
        self.values = np.array([simulation.inputs[name] for name in self._inputs])
        self.outputs = self._read()
        self._state: Mapping[str, np.ndarray] = simulation.state
        self._time = simulation.time
        self._made: np.ndarray | None = None  # values of the step that the simulation has made since then
        self._asked: np.ndarray | None = None  # of the last call

    def __repr__(self) -> str:
        return f"Connector(time={self.time:.6g} s, inputs={list(self._inputs)}, outputs={list(self._outputs)})"

    @property
    def time(self) -> float:
        """The time [s] of the last accepted step; `values` and `outputs` are those of it."""
        return self._time

    def __call__(self, values: Sequence[float] | np.ndarray) -> np.ndarray:
        """The outputs at the end of the next step if the inputs are `values` (inputs,) there."""
        wanted = require_array(values, "Connector: values", (len(self._inputs),))
        found = self._try(wanted)
        self._asked = wanted
        return found

    def tangent(self, values: Sequence[float] | np.ndarray, changes: float | Sequence[float]) -> np.ndarray:
        """(outputs, inputs) derivatives of the outputs at the end of the next step by the inputs there, about `values`,
        by central differences over plus and minus `changes` [units of the inputs]: two steps for each input. Raises
        `InputError` and `RunError` as a call."""
        about = require_array(values, "Connector: values", (len(self._inputs),))
        sizes = np.broadcast_to(np.asarray(changes, dtype=float), about.shape)
        if not np.all(np.isfinite(sizes) & (sizes > 0)):
            raise InputError(f"Connector: changes must be positive numbers, one or one for each input, got {changes!r}")
        columns = [
            (self._try(about + step) - self._try(about - step)) / (2.0 * size)
            for step, size in zip(np.diag(sizes), sizes, strict=True)
        ]
        return np.stack(columns, axis=1)

    def accept(self) -> None:
        """Let the step of the last call be made: the next one begins at its end. Raises `InputError` without a call."""
        if self._asked is None:
            raise InputError("Connector: there is no step to accept; call the connector with values first")
        self.outputs = self._try(self._asked)
        self.values, self._asked, self._made = self._asked, None, None
        self._state, self._time = self.simulation.state, self.simulation.time

    def _try(self, values: np.ndarray) -> np.ndarray:
        """The outputs of the next step with `values`; that step is what the simulation has made."""
        sim = self.simulation
        if self._made is None or not np.array_equal(self._made, values):
            if self._made is not None:
                sim.state = self._state
            self._made = np.full_like(values, np.nan)  # of a step that fails
            for name, value in zip(self._inputs, values.tolist(), strict=True):
                sim.inputs[name] = value
            if sim.step() != Status.COMPLETED:
                raise RunError(sim.result())
            self._made = values.copy()
        return self._read()

    def _read(self) -> np.ndarray:
        return np.concatenate([np.ravel(self.simulation.outputs[name]) for name in self._outputs])
