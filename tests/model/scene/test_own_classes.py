"""Classes that the package does not know: what needs code on the device is refused with the kinds that it has."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.laws.curves import Power
from warpffrf.online.compile.layers import fill_layers


@dataclass(frozen=True)
class Thinning(wf.oils.Oil):
    """Less viscous under pressure."""

    kind: ClassVar[str] = "thinning"

    def viscosity_at(self, pressure: Any) -> np.ndarray:
        return self.viscosity / (1.0 + 1e-8 * np.asarray(pressure, float))

    def viscosity_slope(self, pressure: Any) -> np.ndarray:
        return -1e-8 * self.viscosity / (1.0 + 1e-8 * np.asarray(pressure, float)) ** 2


class Foam(Power):
    """A form that the kernels do not have."""

    form = "foam"


@dataclass(frozen=True, eq=False, kw_only=True)
class Stub(wf.surfaces.Cylinder):
    """A cylinder by another name."""

    kind = "stub"


def contact(curve: Any) -> Any:
    return SimpleNamespace(name="pad", law=SimpleNamespace(kind="mine", bent=curve))


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: wf.oils.as_oil(Thinning(0.04), "film"), "form ''; the kernels evaluate newtonian, barus, roelands"),
        (lambda: wf.joints.Row("screw", 0), "joints.Row: kind 'screw' does not exist; known: 'translation'"),
        (
            lambda: fill_layers(SimpleNamespace(scene=SimpleNamespace(finite_sliding=[contact(Foam(1e9, 2.0))]))),  # pyright: ignore
            "'pad': the curve of the law mine has the form 'foam'; the kernels evaluate power, exponential, table; ret",
        ),
        (lambda: wf.surfaces.from_description({"kind": "mine"}), "a class of your own must be defined before"),
    ],
)
def test_what_needs_a_kernel_or_a_class_is_named(made: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        made()


def test_a_surface_of_ones_own_is_read_from_a_file() -> None:
    own = Stub(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 0, 1))
    found = wf.surfaces.from_description(own.describe())
    assert type(found) is Stub and found.describe() == own.describe()


class Nameless(wf.sensors.JointReaction):
    """A sensor without a kind."""

    kind = ""


def test_a_class_without_a_kind_is_refused() -> None:
    scene = wf.Scene()
    body = scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="body")
    pin = scene.add(wf.joints.Revolute(scene.ground, body.at((0, 0, 0)), axis=(0, 0, 1)))
    with pytest.raises(InputError, match="scene: Nameless has no kind; give the class one"):
        scene.add(Nameless(pin))


def test_a_base_without_what_it_needs_is_not_made() -> None:
    for base in (wf.sensors.Sensor, wf.forces.Force, wf.integrators.Integrator, wf.bases.Basis):
        with pytest.raises(TypeError, match="abstract"):
            base()  # pyright: ignore[reportAbstractUsage]
