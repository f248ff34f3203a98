"""A contact surface without compliance: of a rigid body or of the ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.surfaces import SHAPES, Shape
from warpffrf.model.surfaces.form_deviations import RoundForm


@dataclass(frozen=True, eq=False)
class RigidSurface:
    """A true rigid shape, in the user frame of its body; it has no grid, and no end unless
    its profile is a table: contact-fixed cells then lie within the table, and beyond it the profile continues with its
    last slope. form: its deviation around the
    axis, used by lumped contacts, None without. The other names are those of `ContactSurface`, all empty, so that a
    pair treats both of its surfaces equally.
    """

    name: str
    shape: Any
    form: RoundForm | None = None
    grid: None = None
    tangential: None = None
    local_mass: None = None
    sampling: None = None

    @property
    def local_modes(self) -> int:
        """None: 0."""
        return 0

    @classmethod
    def of(cls, name: Any, shape: Any, owner: str, form: Any = None) -> RigidSurface:
        """A checked one. Raises `InputError` naming `owner`."""
        if not isinstance(name, str) or not name or "/" in name:
            raise InputError(f"{owner}: the name of a surface must be a non-empty text without '/', got {name!r}")
        if not isinstance(shape, Shape):
            kinds = ", ".join(f"surfaces.{kind.__name__}" for kind in SHAPES.values())
            raise InputError(f"{owner}: surface {name!r} must be one of {kinds}, got {shape!r}")
        shape = shape.without_nodes()
        if not shape.resolved:
            raise InputError(
                f"{owner}: surface {name!r} leaves something to be fitted, but a rigid surface has no nodes; give "
                f"{' and '.join(shape.missing)} in {type(shape).__name__}(...)"
            )
        if form is not None:
            form = RoundForm.of(form, shape, f"{owner}: surface {name!r}")
        return cls(name, shape, form)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        described = self.shape.describe()
        return described if self.form is None else described | {"form": self.form.describe()}
