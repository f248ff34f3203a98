"""A simulation that is stepped from outside: `Simulation`.

Between two steps the caller reads outputs and sets inputs; controllers (`warpffrf.control`) and a function of the
caller do so before every step. Without changes of inputs the numbers are those of `simulate`, bit for bit. The steps
themselves are in `warpffrf.online.stepping`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.checks.scene import signals_in
from warpffrf.model.control import Controller, Sampled, error_of
from warpffrf.model.errors import MOST_COUNTED, InputError, require_count, require_number, unknown_name
from warpffrf.model.integrators import CHECK_INTEGRATORS
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.status import Status
from warpffrf.model.pieces import Input
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import SAME_TIME, step_count
from warpffrf.online import Engine, Settings
from warpffrf.online.compile.parameters import Parameters
from warpffrf.online.history.present import Present
from warpffrf.online.history.sensors import sensor_values
from warpffrf.online.running import refuse_signals, velocity_jumps
from warpffrf.online.stepping import Stepping
from warpffrf.online.turns import Turns
from warpffrf.output.files.fields import BODY_FIELDS, JOINT_FIELDS, of_owner
from warpffrf.output.files.table import quantity, series_of
from warpffrf.output.options import DEFAULT_INTEGRATOR, RunOptions, require_options
from warpffrf.output.pace import Pace, as_pace
from warpffrf.output.result import Result
from warpffrf.output.simulate import known_scene, run_arguments, starting_from

CONTROLLER = "controller_"  # prefix of arrays of a state that are of a controller
TURNS = "turns_"  # prefix of those that are counted angles of a joint


class Settable(MutableMapping[str, float]):
    """Values by name of what may be set between steps, those set last, with their `units`. Raises `InputError` for an
    unknown name, and for what is no finite number."""

    kind: ClassVar[str]

    def __init__(self, simulation: Simulation, units: Mapping[str, str]) -> None:
        self._simulation, self.units = simulation, dict(units)

    def __getitem__(self, name: str) -> float:
        return self._simulation._stepping.value(self._known(name))

    def __setitem__(self, name: str, value: float) -> None:
        if type(value) is not float or not -np.inf < value < np.inf:
            value = require_number(value, f"Simulation: {self.kind} {name!r}")
        self._simulation._stepping.set(self._known(name), value)

    def _known(self, name: str) -> str:
        if name not in self.units:
            raise unknown_name(f"Simulation: {self.kind}", name, self.units)
        return name

    def __delitem__(self, name: str) -> None:
        raise InputError(f"Simulation: {self.kind} {name!r} cannot be removed; set it to the value that it shall have")

    def __iter__(self) -> Iterator[str]:
        return iter(self.units)

    def __len__(self) -> int:
        return len(self.units)


class Inputs(Settable):
    """Values of the inputs of a simulation by name, those set last. A value that is set now is reached at the end of
    the next step. Raises `InputError` for an unknown name, and for what is no finite number."""

    kind = "input"

    def __init__(self, simulation: Simulation, sources: Mapping[str, Input]) -> None:
        super().__init__(simulation, {name: source.unit for name, source in sources.items()})
        self.sources = dict(sources)


class ParameterValues(Settable):
    """Values of the parameters of a simulation by name (`stiffness[strut]`, `friction[roller on plate]`), those set
    last. A value that is set now acts from the beginning of the next step on. Raises `InputError` for an unknown name,
    and for a value that it cannot have."""

    kind = "parameter"

    def __init__(self, simulation: Simulation, parameters: Parameters) -> None:
        super().__init__(simulation, {name: each.unit for name, each in parameters.known.items()})
        self._parameters = parameters

    def __setitem__(self, name: str, value: float) -> None:
        number = require_number(value, f"Simulation: parameter {name!r}")
        self._parameters.require(self._known(name), number)
        super().__setitem__(name, number)


class Outputs(Mapping[str, "float | np.ndarray"]):
    """Present values of outputs by name: a sensor, or any history of a result as it calls it
    (`body_angular_velocity_y[rotor]`, `joint_coordinate[hinge]`, `energy[kinetic]`): a number, or an array of the
    components. Its keys are the declared ones. Raises `InputError` for an unknown name."""

    def __init__(self, simulation: Simulation, names: Sequence[str]) -> None:
        self._simulation, self._names = simulation, tuple(names)

    def __getitem__(self, name: str) -> float | np.ndarray:
        return self._simulation._output(name)

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


@named_arguments
class Simulation:
    """A run of `scene` in steps of `step` [s] that is stepped from outside.

    inputs: values by name for the first step, as set in `sim.inputs`; the `signals.Input`s of the scene's forces and
    drives are there. outputs: names that `sim.outputs` lists, None: all sensors; others may be read as well. start: as
    of `simulate`. controllers: of `wf.control`, evaluated before every step, then before_step(sim), a function.
    options: as of `simulate`, with an integrator of time steps; save_every thins the rows of `result()`.

    A step that fails does not raise: `step` and `run` return the `status`, and the next one raises `InputError` with
    the reason. `parameters`: constants that may change between steps, by name, see docs/stepping.md. Raises
    `InputError` for wrong input.

    >>> torque = wf.signals.Input("motor torque", unit="N m")
    >>> rig = wf.Scene()
    >>> rotor = rig.add_rigid_body(1.0, (0.1, 0.2, 0.1), name="rotor")
    >>> shaft = rig.add(wf.joints.Revolute(rig.ground, rotor, axis=(0, 1, 0), name="shaft"))
    >>> _ = rig.add(wf.forces.PointTorque(rotor, (torque, (0, 1, 0))))
    >>> sim = wf.Simulation(rig, step=1e-3)
    >>> sim.inputs["motor torque"] = 3.0
    >>> sim.run(0.1)
    <Status.COMPLETED: 'completed'>
    >>> round(float(sim.outputs["body_angular_velocity_y[rotor]"]), 4)  # rad/s, of 3 N m, after a ramp of one step
    1.4925
    """

    def __init__(
        self,
        scene: Scene,
        *,
        step: float,
        inputs: Mapping[str, float] | None = None,
        outputs: Sequence[str] | None = None,
        start: str | os.PathLike[str] | Result = "initial",
        controllers: Sequence[Controller] = (),
        before_step: Callable[[Simulation], object] | None = None,
        options: RunOptions = RunOptions(),  # noqa: B008 (frozen)
    ) -> None:
        known_scene(scene, "Simulation")
        require_options(options, "Simulation")
        if isinstance(options.integrator, CHECK_INTEGRATORS):
            raise InputError(
                f"Simulation: {type(options.integrator).__name__} is for checks of whole runs; use GeneralizedAlpha, "
                "HHT or Newmark"
            )
        if before_step is not None and not callable(before_step):
            raise InputError(f"Simulation: before_step must be a function of the simulation, got {before_step!r}")
        self.scene = scene
        self._step = require_number(step, "Simulation: step", positive=True)
        beginning = starting_from("Simulation", scene, start)
        own = run_arguments(options)
        tolerance = own.pop("energy_tolerance", None)
        settings = Settings() if tolerance is None else Settings(energy_tolerance=tolerance)
        own["integrator"] = own["integrator"] or DEFAULT_INTEGRATOR
        self._stepping = Stepping(
            scene, step=self._step, start=beginning, settings=settings, progress=False, engine_of=Engine, **own
        )
        if not self._stepping.stopped:
            refuse_signals(scene, self._stepping.time, self._stepping.time)
        items = (*scene.drives, *scene.forces)
        ends = [signal.covers[1] for item in items for signal in signals_in(vars(item))]
        self._end_of_signals = min(ends, default=np.inf) * (1.0 + SAME_TIME)  # s, with the round-off of a run
        self._jumps = np.concatenate([np.zeros(0), *(velocity_jumps(drive)[0] for drive in scene.drives)])  # s
        self._until = self._time_to_check()
        self._controllers: list[tuple[Controller, Sampled]] = []
        self._present: tuple[Any, Present] | None = None  # with the step that it is of
        self._turns = Turns()
        self._readers: dict[str, Callable[[Present], float | np.ndarray]] = {}  # by the names of outputs
        self._stepping.on_look = self._last_rows_if_counting
        self.inputs = Inputs(self, self._stepping.inputs.inputs)
        self.parameters = ParameterValues(self, self._stepping.parameters)
        self.outputs = Outputs(self, [str(s.name) for s in scene.sensors] if outputs is None else list(outputs))
        for name, value in (inputs or {}).items():
            self.inputs[name] = value
        if not self._stepping.stopped:
            for name in self.outputs:
                self._output(name)
        self._controllers = self._connected(controllers)
        ends = [signal.covers[1] for one, _ in self._controllers for signal in one.references]
        self._end_of_references = min(ends, default=np.inf) * (1.0 + SAME_TIME)
        self._before_step = before_step
        self._live: tuple[Any, int] | None = None  # frames that are sent, and every how many steps
        self.pace: Pace | None = None  # of the last run in real time

    def __repr__(self) -> str:
        return f"Simulation(time={self.time:.6g} s, status={str(self.status)!r}, inputs={dict(self.inputs)})"

    # --- the present

    @property
    def time(self) -> float:
        """The present time [s]."""
        return self._stepping.time

    @property
    def status(self) -> Status:
        """completed, as long as all steps were, or what stopped the run."""
        return Status(self._stepping.history().status) if self._stepping.stopped else Status.COMPLETED

    @property
    def message(self) -> str:
        """What stopped the run, and the remedy; empty while it goes on."""
        return self._stepping.history().message if self._stepping.stopped else ""

    # --- steps

    def step(self) -> Status:
        """Make one step: controllers and before_step first, then inputs change linearly over it.

        Returns the status. Raises `InputError` after a failure, and beyond the end of a signal of the scene."""
        stepping = self._stepping
        if stepping.stopped:
            self._refuse()
        if stepping.time + self._step > self._until:
            refuse_signals(self.scene, stepping.time, stepping.time + self._step)
        if self._controllers:
            self._control()
        if self._before_step is not None:
            self._before_step(self)
        if not stepping.step():
            return self.status
        if self._live is not None and stepping.running.done % self._live[1] == 0:
            self._live[0].frame(self._present_alone(), self.outputs)
        return Status.COMPLETED

    def run(self, duration: float, *, real_time: bool | Pace = False) -> Status:
        """Make the steps of `duration` [s], a multiple of the step, with controllers and before_step, or as far as they
        succeed; returns the status. real_time: no step ends before its time by the clock; `pace` then says how many
        were late. Raises `InputError` as `step`, and for a duration that is no positive multiple."""
        require_number(duration, "Simulation: duration", positive=True)
        steps = step_count(duration, self._step)[0]
        if abs(steps * self._step - duration) > SAME_TIME * duration:
            raise InputError(
                f"Simulation: the duration {duration:g} s is no multiple of the step {self._step:g} s; inputs change "
                f"between whole steps only: run {steps * self._step:g} s, or take another step"
            )
        pace = as_pace(real_time)
        if pace is not None:
            self.pace = pace
            pace.run(lambda: self.step() == Status.COMPLETED, duration, steps)
            return self.status
        if self._controllers or self._before_step is not None or self._live is not None:
            for _ in range(steps):
                if self.step() != Status.COMPLETED:
                    break
            return self.status
        if self._stepping.stopped:
            self._refuse()
        refuse_signals(self.scene, self.time, self.time + steps * self._step)
        self._stepping.advance(steps)
        return self.status

    def _time_to_check(self) -> float:
        """The time [s] beyond which a step may have to be refused for its signals."""
        return min(self._end_of_signals, float(self._jumps[self._jumps >= self.time].min(initial=np.inf)))

    def _refuse(self) -> None:
        raise InputError(
            f"Simulation: it has ended at t = {self.time:.6g} s ({self.status}: {self.message}); set an earlier state, "
            "sim.state = ..., or begin another one"
        )

    def result(self) -> Result:
        """The Result up to now, as that of `simulate`, without an error budget; the simulation goes on. Its rows begin
        at the start, or at the state that was set last."""
        return Result(self._stepping.history())

    def stream_to(self, stream: Any, *, every: int = 1, deformation_factor: float = 1.0) -> None:
        """Send the present to `stream`, a `rerun.RecordingStream`, now and after every `every`th step: bodies, with the
        elastic displacement times deformation_factor, and the declared outputs. Where it goes, to a viewer, a file or a
        server, is the caller's choice; None ends it. A present that is not finite is left out. Raises `InputError`."""
        from warpffrf.output.recording.live import Live

        if stream is None:
            self._live = None
            return
        if self._stepping.stopped:
            self._refuse()
        every = require_count(every, "stream_to: every", 1)
        labels = {name: self._labels(name) for name in self.outputs}
        live = Live(stream, self._present_alone(), labels, deformation_factor)
        self._live = live, every
        live.frame(self._present_alone(), self.outputs)

    def _present_alone(self) -> Result:
        """The Result of the present, one row."""
        stepping = self._stepping
        return Result(Present(stepping.engine.compiled, stepping.rows(MOST_COUNTED)[0]).history)

    def _labels(self, name: str) -> list[str]:
        """Names of the components of an output."""
        count = np.size(self._output(name))
        return [name] if count == 1 else [f"{name} {axis}" for axis in ("xyz" if count == 3 else range(count))]

    # --- states

    @property
    def state(self) -> dict[str, np.ndarray]:
        """A copy of everything that the next steps depend on, arrays (...) [SI units] by name: bodies, contacts, inputs
        and controllers. Setting it continues from there, bit for bit with the same step (with small-sliding contacts
        to round-off); rows before are dropped, and values set for the next step as well. Raises `InputError` for a
        state of another scene, and for one that is damaged, before anything is changed."""
        if self._stepping.running.failed:
            raise InputError(f"Simulation: it did not start ({self.status}: {self.message}), so that it has no state")
        found = self._stepping.state()
        found |= {f"{CONTROLLER}{i}": block.state.copy() for i, (_, block) in enumerate(self._controllers)}
        return found | {TURNS + name: array for name, array in self._turns.counts(self._last_rows()).items()}

    @state.setter
    def state(self, state: Mapping[str, np.ndarray]) -> None:
        if not isinstance(state, Mapping):
            raise InputError(f"Simulation: state must be what sim.state has returned, got {type(state).__name__}")
        if self._stepping.running.failed:
            self._refuse()
        blocks = [block for _, block in self._controllers]
        given = [np.asarray(state.get(f"{CONTROLLER}{i}")) for i in range(len(blocks))]
        if any(one.shape != block.state.shape for one, block in zip(given, blocks, strict=True)):
            raise InputError("Simulation: state is of a Simulation with other controllers; make this one with the same")
        self._stepping.put(state)
        for one, block in zip(given, blocks, strict=True):
            block.state = one.copy()
        names = [name for name in state if name.startswith(TURNS)]
        self._turns = Turns({name.removeprefix(TURNS): np.array(state[name]) for name in names})
        self._present = None
        self._until = self._time_to_check()

    # --- outputs

    def _output(self, name: str) -> float | np.ndarray:
        """The present value of one output."""
        run = self._last_rows()
        if name not in self._readers:
            self._readers[name] = self._reader(run, name)
        return self._readers[name](run)

    def _reader(self, run: Present, name: str) -> Callable[[Present], float | np.ndarray]:
        """The function that evaluates an output."""
        for sensor in self.scene.sensors:
            if sensor.name == name:
                return lambda run: _plain(sensor_values(sensor, self._whole(run) if sensor.of_result else run)[-1])
        base, _, owner = name.partition("[")
        owner = owner.removesuffix("]")
        bodies: tuple[Any, Any] = BODY_FIELDS, lambda run: run.bodies
        joints: tuple[Any, Any] = JOINT_FIELDS, lambda run: run.joints
        for fields, owners in (bodies, joints):
            for field in fields if owner in owners(run) else ():
                series = series_of(of_owner(field, owners(run)[owner]), owner, owners(run)[owner])
                if series is None or not base.startswith(field.name):
                    continue
                if name == series.label:
                    return lambda run, a=field.attribute, of=owners: _plain(getattr(of(run)[owner], a)[-1])
                if name in series.columns:
                    at = list(series.columns).index(name)
                    return lambda run, a=field.attribute, of=owners, at=at: float(getattr(of(run)[owner], a)[-1, at])
        return lambda run: _plain(quantity(self._whole(run), name).values[-1])

    def _last_rows(self) -> Present:
        """The rows since they were last asked for, up to the present."""
        stepping = self._stepping
        if stepping.running.failed:
            self._refuse()
        key = stepping.running, stepping.running.done
        if self._present is None or self._present[0] != key:
            self._present = key, self._turns.present(stepping)
        return self._present[1]

    def _last_rows_if_counting(self) -> None:
        """Count the revolutions of joints whose coordinates are read, before their rows are overwritten."""
        if self._turns.counting:
            self._last_rows()

    def _whole(self, run: Present) -> Result:
        """The Result of some rows."""
        run.history.joints.update({name: run.joints[name] for name in run.joints})
        return Result(run.history)

    # --- controllers

    def _connected(self, controllers: Sequence[Controller]) -> list[tuple[Controller, Sampled]]:
        """Each with its discrete form at its sample time; names and signals are checked."""
        found, owners = [], {}
        for number, one in enumerate(controllers):
            if not isinstance(one, Controller):
                raise InputError(f"Simulation: controllers are those of wf.control, got {one!r}")
            label = f"Simulation: controller {number} ({type(one).__name__})"
            for target in one.targets:
                if target not in self.inputs:
                    raise unknown_name(f"{label}: input", target, self.inputs)
                if target in owners:
                    raise InputError(f"{label}: input {target!r} is set by controller {owners[target]} already")
                owners[target] = number
            for name in one.measures if not self._stepping.stopped else ():
                if np.ndim(self._output(name)):
                    raise InputError(
                        f"{label}: {name!r} has several components; name one as a result does: sensor_x[{name}]"
                    )
            found.append((one, one.sampled(self._step * one.every)))
        return found

    def _control(self) -> None:
        done, t = self._stepping.running.done, self.time
        if t > self._end_of_references:
            raise InputError(
                f"Simulation: the reference of a controller ends before t = {t:.6g} s; extend it, or give a Table "
                "hold=True if its end values hold"
            )
        for one, block in self._controllers:
            if done % one.every:
                continue
            measured = np.array([self._output(name) for name in one.measures], dtype=float)
            command = block.command(error_of(one, t, measured))
            if not np.all(np.isfinite(command)):
                raise InputError(
                    f"Simulation: {type(one).__name__} of {', '.join(map(repr, one.targets))} commands a NaN or "
                    f"infinite number at t = {t:.6g} s; its loop is unstable, or an output is not finite"
                )
            for name, value in zip(one.targets, command.tolist(), strict=True):
                self._stepping.set(name, value)


def _plain(values: Any) -> float | np.ndarray:
    """A number for one component, else a copy of the components."""
    return float(np.ravel(values)[0]) if np.size(values) == 1 else np.array(values)
