"""Treatment of the local modes of contact surfaces: quasi-static, or with inertia.

    quasi_static   the compliance D contains all modes; nothing per mode is stored or integrated
    hht            the modes of `warpffrf.model.reduced.local_modes` as diagonal coordinates, one HHT-alpha step each
    exponential    the same coordinates, exact for a load that is linear over the step
    auto           hht up to AUTO_RATIO times the highest load frequency, quasi_static above

Modes without inertia remain in the compliance (D_rest), so that the static response is exact at any cut-off. Contact
uses `G = Psi^T (D_rest + T sigma^-1 T^T) Psi` and stays inside the local solve in all treatments; the cost of the
dynamic ones grows with the number of modes (kernels `motion`, `contact_compliance`), and G changes with the step size.

The steps (`warpffrf_kernels.bodies.motion.move_modes`). HHT: its own four coefficients of alpha replace
those of the integrator of the retained coordinates. Exponential, for q'' + 2 zeta omega q' + omega^2 q = f0 + (f1 - f0)
t/h (Nigam and Jennings 1969): q1 = A q0 + B q0' + C f0 + D f1; D is the receptance. It serves modes that the step does
not resolve, omega h >= pi; below that, with contact, it would be unstable (`warpffrf_kernels.bodies.motion.rule_of`),
and those modes use HHT. It is marginally stable for undamped modes, hence the default damping. Impacts on these modes
are integrated without a history of the contact force, see `warpffrf_kernels.impulsive.impulsive_means`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from warpffrf.model.bodies import SurfacePort
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_count, require_number, unknown_name
from warpffrf.model.integrators import HHT, Coefficients
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.reduced.local_modes import DynamicModes, dynamic_modes
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.model.scene import Scene

TREATMENTS = ("quasi_static", "hht", "exponential", "auto")
AUTO_RATIO = 5.0  # of the load frequency: above, the error of the response without inertia is at most (1/5)^2 = 4 %
EXACT_DAMPING = 0.02  # 2 %: the smallest of 0, 2, 10 % that was stable from 2 to 20 us per step on two rollers
FOLLOWS, STEPS_HHT, STEPS_EXACTLY = (
    0,
    1,
    2,
)  # kinds of modes in the kernels: the integrator of the retained coordinates's, hht, exponential


@named_arguments
@dataclass(frozen=True)
class LocalModes:
    """The `treatment` of the local modes, "quasi_static", "hht", "exponential" or "auto", see the module;
    `RunOptions(local_modes="hht")` is short for `LocalModes("hht")`.

    max_frequency [Hz], count: the modes of each contact surface with inertia, all that can be resolved if both are
    None. damping: their ratio, 0 to below 1; None: zero with HHT, which damps numerically, and EXACT_DAMPING with
    "exponential". alpha: of HHT, -1/3 to 0. load_frequency [Hz]: of "auto", the highest
    frequency of the load; the highest global mode of the body if None. Raises `InputError`.
    """

    treatment: str = "quasi_static"
    max_frequency: float | None = None
    count: int | None = None
    damping: float | None = None
    alpha: float = -0.3
    load_frequency: float | None = None

    def __post_init__(self) -> None:
        if self.treatment not in TREATMENTS:
            raise unknown_name("local_modes", self.treatment, TREATMENTS)
        for name in ("max_frequency", "load_frequency"):
            if getattr(self, name) is not None:
                require_number(getattr(self, name), f"local_modes: {name}", positive=True)
        if self.count is not None:
            require_count(self.count, "local_modes: count", 0)
        if not 0.0 <= require_number(self.ratio, "local_modes: damping") < 1.0:
            raise InputError(f"local_modes: damping is a ratio from 0 to below 1, got {self.damping!r}")
        HHT(self.alpha)
        if self.treatment == "quasi_static" and (self.max_frequency is not None or self.count is not None):
            raise InputError("local_modes: 'quasi_static' gives no mode inertia; max_frequency and count go with 'hht'")
        if self.load_frequency is not None and self.treatment != "auto":
            raise InputError("local_modes: load_frequency goes with 'auto'; give max_frequency instead")

    @property
    def coefficients(self) -> Coefficients:
        """Coefficients of HHT."""
        return HHT(self.alpha).coefficients

    @property
    def ratio(self) -> float:
        """Damping ratio in use."""
        if self.damping is None:
            return EXACT_DAMPING if self.treatment == "exponential" else 0.0
        return self.damping

    @property
    def kind(self) -> int:
        """Kind of its modes in the kernels."""
        return STEPS_EXACTLY if self.treatment == "exponential" else STEPS_HHT


def as_local_modes(value: Any) -> LocalModes:
    """`value` itself, or the treatment of that name; raises `InputError`."""
    return value if isinstance(value, LocalModes) else LocalModes(value)


@dataclass
class LocalPlan:
    """The dynamic local modes of a scene: per body index its surfaces' modes by name, in the order of the coordinates
    that follow its global ones; and notes about them."""

    options: LocalModes
    modes: dict[int, dict[str, DynamicModes]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, scene: Scene, options: LocalModes) -> LocalPlan:
        """The plan of all surfaces in contact; raises `InputError` for one that was reduced without their inertia."""
        plan = cls(options)
        for contact in scene.finite_sliding:
            for port in contact.ports:
                if port.surface.grid is None or port.surface.half_space:
                    continue  # no modes
                if options.treatment != "quasi_static":
                    plan._add(port)
                    continue
                note = f"contact surface {port.label}: the inertia of its local modes is neglected"
                if note not in plan.notes:  # several contacts share the surface
                    plan.notes.append(note)
        for contact in scene.small_sliding:
            plan._look_at_contact(contact)
        if any(plan.count(body) for body in plan.modes):
            plan.notes.append("pictures and stresses show dynamic local modes as if at rest under the pressure")
        return plan

    def _look_at_contact(self, contact: Contact) -> None:
        """Note that its cells have no inertia; raises `InputError` if local modes of its bodies have inertia, as these
        do not move small-sliding contacts."""
        for port in contact.ports:
            if self.count(port.body.index):
                raise InputError(
                    f"{contact.label}: local_modes {self.options.treatment!r} gives inertia to local modes of body "
                    f"{port.body.name!r}, which do not move its small-sliding contacts; take "
                    "local_modes='quasi_static' and reduce it with more global modes (max_frequency=)"
                )
        self.notes.append(f"{contact.label}: its cells yield without inertia, beyond the global modes of its bodies")

    def _add(self, port: SurfacePort) -> None:
        own = self.modes.setdefault(port.body.index, {})
        if port.name in own:
            return
        surface = port.surface
        if surface.local_mass is None:
            raise InputError(
                f"contact surface {port.label}: local_modes {self.options.treatment!r} needs the inertia of its local "
                "modes; reduce with local_dynamics=True"
            )
        highest = self.options.max_frequency
        if self.options.treatment == "auto":
            frequencies = port.body.reduced.frequencies
            load = self.options.load_frequency or float(np.max(frequencies, initial=0.0))
            highest = AUTO_RATIO * load if highest is None else min(highest, AUTO_RATIO * load)
        found = dynamic_modes(surface, count=self.options.count, max_frequency=highest)
        own[port.name] = found
        n = len(found.omega)
        reach = f" up to {found.omega[-1] / (2.0 * np.pi):.4g} Hz" if n else ""
        self.notes.append(
            f"contact surface {port.label}: {n} of {surface.local_modes} local modes are dynamic "
            f"({self.options.treatment}){reach}; the others follow the load without inertia"
        )

    @property
    def exact(self) -> bool:
        """Whether any mode uses the exponential step."""
        return self.options.kind == STEPS_EXACTLY and any(self.count(b) for b in self.modes)

    def count(self, body: int) -> int:
        """Number of dynamic local modes of a body."""
        return sum(len(modes.omega) for modes in self.modes.get(body, {}).values())

    def omega(self, body: int) -> np.ndarray:
        """Their frequencies (n,) [rad/s]."""
        return np.concatenate([np.zeros(0), *(modes.omega for modes in self.modes.get(body, {}).values())])

    def surface(self, port: SurfacePort) -> ContactSurface | RigidSurface:
        """The contact surface with the traces of all modes of its body, and the compliance of the rest."""
        own = self.modes.get(port.body.index, {})
        if not own:
            return port.surface
        nodes = len(port.surface.mode_normal)
        traces = {name: np.zeros((nodes, len(modes.omega))) for name, modes in own.items()}
        traces[port.name] = own[port.name].trace
        return replace(
            port.surface,
            lags=own[port.name].residual_lags,
            mode_normal=np.concatenate([port.surface.mode_normal, *traces.values()], axis=1),
        )


def refuse_other_modes(scene: Scene, stages: Sequence[Any], local_modes: Any) -> None:
    """Raises `InputError` for a stage whose local treatment integrates other modes than the stages before it: the state
    of a run has one coordinate per mode."""
    treatments = [as_local_modes(stage.options.get("local_modes", local_modes)) for stage in stages]
    if len(set(treatments)) == 1:
        return
    first: list[int] = []
    for stage, treatment in zip(stages, treatments, strict=True):
        plan = LocalPlan.of(scene, treatment)
        counts = [len(modes.omega) for own in plan.modes.values() for modes in own.values()]
        counts = counts if any(counts) else []
        if stage is stages[0]:
            first = counts
        elif counts != first:
            raise InputError(
                f"stage {stage.name!r}: local_modes {treatment.treatment!r} gives {sum(counts)} local modes "
                f"inertia, stage {stages[0].name!r} {sum(first)}; the modes of a run cannot change: "
                "give both the same max_frequency"
            )
