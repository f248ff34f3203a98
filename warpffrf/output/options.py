"""`RunOptions`: settings of a run that are rarely needed."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from warpffrf.model.errors import MOST_COUNTED, InputError, require_count, require_number
from warpffrf.model.integrators import (
    CHECK_INTEGRATORS,
    INTEGRATORS,
    EnergyMomentum,
    GeneralizedAlpha,
    Integrator,
    RungeKutta4,
)
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.online.local_modes import LocalModes, as_local_modes

DEFAULT_INTEGRATOR = GeneralizedAlpha(rho_inf=0.8)
OF_TIME = ("integrator", "step_error", "energy_tolerance", "project_start")  # fields without meaning in a static run


@named_arguments
@dataclass(frozen=True, repr=False)
class RunOptions:
    """Settings of a run that are rarely needed, for `simulate`, `static` and `simulate_worlds` (`options=`).

    local_modes: treatment of the local modes of contact surfaces: "quasi_static", or "hht", "exponential", "auto" or a
        `LocalModes` for bodies that were reduced with local_dynamics=True.
    integrator: GeneralizedAlpha, HHT, Newmark or an own `integrators.Integrator`; RungeKutta4 and EnergyMomentum for
        checks on free bodies; None: GeneralizedAlpha(rho_inf=0.8).
    step_error: steps whose local error exceeds it are halved (positions in m, with rotations in rad times the radius of
        gyration; stiff local modes do not count); `step` is then the longest step. None: no limit.
    energy_tolerance: relative energy gain (of the current energy) above which a step with an impact is halved; None:
        2.5e-4.
    save_every: every `save_every`th step is saved, and the last.
    device: where kernels run, "cpu" or "cuda:0"; None: the environment variable WARPFFRF_DEVICE, otherwise the CPU.
    project_start: True: initial velocities that violate the joints are changed as little as possible, with a note,
        instead of refused. Velocities of driven bodies are changed in any case.

    A static run uses local_modes, save_every and device only. Raises `InputError` for wrong values.

    >>> wf.RunOptions(save_every=10, device="cpu")
    RunOptions(save_every=10, device='cpu')
    """

    local_modes: str | LocalModes = "quasi_static"
    integrator: Integrator | RungeKutta4 | EnergyMomentum | None = None
    step_error: float | None = None
    energy_tolerance: float | None = None
    save_every: int = 1
    device: str | None = None
    project_start: bool = False

    def __post_init__(self) -> None:
        as_local_modes(self.local_modes)
        require_integrator(self.integrator, "RunOptions")
        for name in ("step_error", "energy_tolerance"):
            if getattr(self, name) is not None:
                value = require_number(getattr(self, name), f"RunOptions: {name}", positive=True)
                object.__setattr__(self, name, value)
        if self.energy_tolerance is not None and isinstance(self.integrator, CHECK_INTEGRATORS):
            raise InputError(
                f"RunOptions: energy_tolerance halves steps, and {type(self.integrator).__name__} has equal steps; "
                "leave it out"
            )
        save_every = require_count(self.save_every, "RunOptions: save_every", 1, most=MOST_COUNTED)
        object.__setattr__(self, "save_every", save_every)
        if self.device is not None and not isinstance(self.device, str):
            raise InputError(f"RunOptions: device must be 'cpu' or 'cuda:0', got {self.device!r}")
        if not isinstance(self.project_start, bool):
            raise InputError(f"RunOptions: project_start must be True or False, got {self.project_start!r}")

    def __repr__(self) -> str:
        chosen = (f"{f.name}={value!r}" for f in fields(self) if (value := getattr(self, f.name)) != f.default)
        return f"RunOptions({', '.join(chosen)})"


def require_options(options: Any, where: str, *, static: bool = False) -> RunOptions:
    """`options` themselves. Raises `InputError` if they are no `RunOptions`, or have a field without meaning in a
    `static` run."""
    if not isinstance(options, RunOptions):
        raise InputError(f"{where}: options must be wf.RunOptions(...), got {options!r}")
    for name in OF_TIME if static else ():
        if getattr(options, name) != getattr(RunOptions, name):
            raise InputError(f"{where}: {name} is for runs in time; a static run has none, leave it out")
    return options


def require_integrator(integrator: Any, where: str) -> None:
    """Raises `InputError` for anything but an integrator or None."""
    if integrator is not None and not isinstance(integrator, (Integrator, *CHECK_INTEGRATORS)):
        names = ", ".join(f"integrators.{kind.__name__}()" for kind in INTEGRATORS.values())
        raise InputError(
            f"{where}: integrator must be one of {names}, or an integrators.Integrator of your own, got "
            f"{integrator!r}; names are for scene files"
        )
