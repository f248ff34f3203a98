"""Choices of a study, and the combinations to run.

    step                                of `simulate`
    local_modes, integrator             of `RunOptions`
    grid, quadrature, cell_error        of all distributed contacts of the scene
    inertia                             of all flexible bodies
    stiffening                          of flexible bodies reduced with it
    any other name                      a parameter of the scene builder: mesh, modes, spacing, ...

A *setting* has a value for each name varied in the study. By default, the steps (2, 1, 1/2 and 1/4 of the given one),
the treatments of local modes, and grids and evaluations are combined with each other, because they interact;
integrators, inertia levels, stiffening and errors of the cells of a patch are varied one at a time from the given
setting. User choices are combined with each other, and everything else is kept.

Settings that a scene does not support are omitted with the reason. In a default study this is determined in advance
from its bodies; for user choices the error of the run is the reason.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

from warpffrf.model.bodies import INERTIA_LEVELS
from warpffrf.model.contact import CELL_ERROR
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.integrators import HHT, GeneralizedAlpha
from warpffrf.online.local_modes import TREATMENTS
from warpffrf.output.options import DEFAULT_INTEGRATOR

RUN = ("step", "local_modes", "integrator")
CONTACT = ("grid", "quadrature", "cell_error")
BODY = ("inertia", "stiffening")
BUILT_IN = (*RUN, *CONTACT, *BODY)
STEP_RATIOS = (2.0, 1.0, 0.5, 0.25)
INTEGRATORS = (DEFAULT_INTEGRATOR, GeneralizedAlpha(rho_inf=0.5), HHT(alpha=-0.3))
MOST_SETTINGS = 200  # of a study; each is run in every round

Setting = dict[str, Any]


@dataclass
class Choices:
    """`settings` to run, the given one first, and the omitted ones, `left_out`: (name, value as text, reason)."""

    settings: list[Setting]
    left_out: list[tuple[str, str, str]] = field(default_factory=list)


def text_of(value: Any) -> str:
    """A value as in tables and folders: for integrators and similar objects the non-default options."""
    if is_dataclass(value) and not isinstance(value, type):
        chosen = [(f.name, getattr(value, f.name)) for f in fields(value) if getattr(value, f.name) != f.default]
        return f"{type(value).__name__}({', '.join(f'{name}={text_of(v)}' for name, v in chosen)})"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def label_of(setting: Setting) -> str:
    """A setting as text, the same in every study."""
    return ", ".join(f"{name}={text_of(value)}" for name, value in setting.items())


def given_choices(choices: Mapping[str, Sequence[Any]], base: Setting) -> Choices:
    """All combinations of the user's `choices`, name -> values, with the other values from the setting `base`. Raises
    `InputError` for lists without values, repeated values, and too many combinations."""
    if not choices:
        raise InputError("speed_error: choices are empty; leave them out for the default ones, or name some")
    count = 1
    for name, values in choices.items():
        if isinstance(values, str) or not isinstance(values, Sequence) or not len(values):
            raise InputError(f"speed_error: choice {name!r} must be a list of values, got {values!r}")
        texts = [text_of(value) for value in values]
        if len(set(texts)) < len(texts):
            raise InputError(f"speed_error: choice {name!r} has a value twice: {', '.join(texts)}")
        if name == "step":
            for value in values:
                require_number(value, "speed_error: choice 'step'", positive=True)
        count *= len(values)
    if count > MOST_SETTINGS:
        sizes = " x ".join(f"{len(values)} of {name}" for name, values in choices.items())
        raise InputError(
            f"speed_error: {sizes} are {count} settings, more than {MOST_SETTINGS}; give fewer values, or make several "
            "studies of a few choices each"
        )
    names = list(choices)
    return Choices([{**base, **dict(zip(names, c, strict=True))} for c in itertools.product(*choices.values())])


def default_choices(scene: Any, base: Setting) -> Choices:
    """The default combinations for `scene`, from the setting `base` (module docstring)."""
    found = Choices([base])
    flexible = [body for body in scene.bodies if body.reduced is not None]
    local = [base["local_modes"], *_other_local(scene, base, found)]
    contact = _contact_choices(scene, base, found)
    steps = [base["step"] * ratio for ratio in STEP_RATIOS]
    found.settings += [
        {**base, **pair, "local_modes": treatment, "step": step}
        for pair, treatment, step in itertools.product(contact, local, steps)
    ]
    alone: list[tuple[str, Any]] = [("integrator", integrator) for integrator in INTEGRATORS]
    if flexible:
        alone += [("inertia", level) for level in _levels(flexible, found)]
        if any(map(can_stiffen, flexible)):
            alone += [("stiffening", kept) for kept in (False, True)]
        else:
            found.left_out.append(("stiffening", "True", "no body was reduced with stiffening=True"))
    else:
        found.left_out.append(("inertia, stiffening", "all", "no body is flexible"))
    if any(_patch_ready(contact) for contact in scene.contacts):
        alone += [("cell_error", error) for error in (4.0 * CELL_ERROR, CELL_ERROR, 0.2 * CELL_ERROR)]
    elif scene.contacts:
        found.left_out.append(("cell_error", "all", "no contact has cells that move with the patch"))
    found.settings += [{**base, name: value} for name, value in alone]
    unique = {label_of(setting): setting for setting in found.settings}
    found.settings = list(unique.values())
    return found


def _other_local(scene: Any, base: Setting, found: Choices) -> list[str]:
    """Other treatments of local modes for which the scene has the mass."""
    others = [t for t in TREATMENTS if t not in ("auto", text_of(base["local_modes"]))]
    surfaces = [port.surface for contact in scene.contacts for port in contact.ports if not port.rigid]
    if not surfaces:
        found.left_out.append(("local_modes", "all others", "no flexible body is in distributed contact"))
        return []
    if any(surface.local_mass is None for surface in surfaces):
        reason = "a body in contact was reduced without local_dynamics=True"
        found.left_out.append(("local_modes", ", ".join(t for t in others if t != "quasi_static"), reason))
        return [t for t in others if t == "quasi_static"]
    return others


def can_stiffen(body: Any) -> bool:
    """Whether a flexible body was reduced with stiffening."""
    return body.reduced.inertia_terms is not None and body.reduced.inertia_terms.stiffening is not None


def _levels(flexible: list[Any], found: Choices) -> list[str]:
    """Inertia levels for which all flexible bodies have terms."""
    names = [level for level in INERTIA_LEVELS if level != "auto"]
    without = [body.name for body in flexible if body.mode_count and body.reduced.inertia_terms is None]
    if without:
        found.left_out.append(("inertia", "all but constant", f"body {without[0]!r} has no inertia terms"))
        return ["constant"]
    return names


def _patch_ready(contact: Any) -> bool:
    """Whether all flexible surfaces of `contact` have the data for a patch of cells."""
    return all(port.rigid or port.surface.far is not None for port in contact.ports)


def _contact_choices(scene: Any, base: Setting, found: Choices) -> list[Setting]:
    """Compatible grids and evaluations."""
    if not scene.contacts:
        found.left_out.append(("grid, quadrature", "all", "the scene has no distributed contact"))
        return [{}]
    pairs: list[Setting] = [{}]  # "auto" uses the patch if possible
    if all(_patch_ready(contact) for contact in scene.contacts):
        pairs.append({"grid": "contact_fixed" if all(c.grid == "body_fixed" for c in scene.contacts) else "material"})
    else:
        found.left_out.append(("grid", "contact_fixed", "a body in contact was reduced without contact_fixed=True"))
    if all(contact.a.surface.sampling is not None for contact in scene.contacts):
        pairs.append({"grid": "body_fixed", "quadrature": "reduced"})
    else:
        found.left_out.append(("quadrature", "reduced", "a first body was reduced without sampling_error"))
    return pairs
