"""Types of user arguments for editors and type checkers; values are checked again at run time.

Strings are sequences of strings, not a `Vector`; NumPy's `ArrayLike` would accept them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Vector: TypeAlias = Sequence[float] | NDArray[Any]  # sequence of numbers: a point, a direction, a quaternion
Matrix: TypeAlias = Sequence[Vector] | NDArray[Any]  # rows of numbers: an inertia tensor, points, a table
RotationLike: TypeAlias = "Vector | Matrix | Mapping[str, Any] | Rotation"  # the forms of `rotation.orientation`
