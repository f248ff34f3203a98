"""Public errors: for an invalid description, with small checks that raise it, and for a run that did not complete."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches
from typing import Any, NoReturn

import numpy as np

from warpffrf.model.renamed import RENAMED

MOST_COUNTED = 2**31 - 1  # counts are 32-bit integers
SYMMETRY_TOLERANCE = 1e-9  # relative asymmetry of an inertia tensor that counts as rounding


class InputError(ValueError):
    """A wrong or incomplete description. The message names the thing at fault and the cure."""


class RunError(RuntimeError):
    """A run that did not complete, raised with `check=True`. The message has its status, the reason and the cure;
    `result` has the data computed so far: a Result, or what `simulate_worlds` or `equilibria` return."""

    def __init__(self, result: Any, ends: Sequence[Any] = ()) -> None:
        """ends: of each of several scenes, with its status and message."""
        failed = [f"scene {i}: {end.status}: {end.message}" for i, end in enumerate(ends) if end.status != "completed"]
        super().__init__("\n".join(failed) if ends else f"{result.status}: {result.message}")
        self.result = result


def require_number(value: Any, name: str, *, positive: bool = False, non_negative: bool = False) -> float:
    """`value` as a finite float, else `InputError` naming `name`; optionally > 0 or >= 0.

    Strings and booleans are not accepted, although Python would convert them; numpy's scalars and arrays () are.
    """
    if isinstance(value, (str, bytes, bool, np.bool_)):
        raise InputError(f"{name} must be a number, got {value!r}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be a number, got {value!r}") from None
    except OverflowError:
        raise InputError(f"{name} must be finite, got an integer beyond all floating-point numbers") from None
    if not np.isfinite(number):
        raise InputError(f"{name} must be finite, got {number}")
    if positive and number <= 0.0:
        raise InputError(f"{name} must be greater than zero, got {number:g}")
    if non_negative and number < 0.0:
        raise InputError(f"{name} must not be negative, got {number:g}")
    return number


def require_count(value: Any, name: str, minimum: int, most: float = np.inf) -> int:
    """`value` as an int from `minimum` to `most`, else `InputError`; 3.0 is accepted, 3.5 is not."""
    number = require_number(value, name)
    if number != int(number) or number < minimum:
        raise InputError(f"{name} must be a whole number of at least {minimum}, got {value!r}")
    if number > most:
        raise InputError(f"{name} must be a whole number of at most {most}, got {value!r}")
    return int(number)


def require_array(value: Any, name: str, shape: tuple[int | None, ...]) -> np.ndarray:
    """`value` as a new finite float64 array of `shape` (None: any length), else `InputError`."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be an array of numbers, got {value!r}") from None
    fits = array.ndim == len(shape) and all(s is None or s == n for s, n in zip(shape, array.shape, strict=True))
    if not fits:
        wanted = "(" + ", ".join("n" if s is None else str(s) for s in shape) + ")"
        raise InputError(f"{name} must have shape {wanted}, got {array.shape}")
    if not np.all(np.isfinite(array)):
        raise InputError(f"{name} holds NaN or infinite numbers")
    return array


def require_inertia(value: Any, name: str) -> np.ndarray:
    """`value`, an inertia tensor (3, 3) or its diagonal (3,) [kg m2], as (3, 3): symmetric, positive, and no principal
    moment exceeds the sum of the other two, else `InputError`."""
    J = np.diag(require_array(value, name, (3,))) if np.ndim(value) == 1 else require_array(value, name, (3, 3))
    if np.max(np.abs(J - J.T)) > SYMMETRY_TOLERANCE * float(np.max(np.abs(J))):
        raise InputError(f"{name} must be symmetric")
    J = 0.5 * (J + J.T)
    moments = np.linalg.eigvalsh(J)
    if not moments[0] > 0.0:
        raise InputError(f"{name}: principal moments must be greater than zero, the smallest is {moments[0]:g} kg m2")
    if moments[2] > (moments[0] + moments[1]) * (1.0 + SYMMETRY_TOLERANCE):
        raise InputError(
            f"{name}: the principal moments {moments[0]:g}, {moments[1]:g}, {moments[2]:g} kg m2 are impossible: the "
            "largest exceeds the sum of the other two; is it about the centre of mass?"
        )
    return J


def require_direction(value: Any, name: str) -> np.ndarray:
    """`value` as a unit vector (3,), else `InputError`; a zero vector has no direction."""
    vector = require_array(value, name, (3,))
    length = float(np.linalg.norm(vector))
    if length == 0.0:
        raise InputError(f"{name} has zero length; give a vector with a direction, such as (0, 1, 0)")
    return vector / length


def unknown_name(kind: str, name: object, known: Iterable[str]) -> InputError:
    """The error for an unknown name: it suggests the nearest known names and lists all."""
    return InputError(f"{kind} {name!r} does not exist{suggestion(str(name), list(known))}")


def suggestion(name: str, known: Sequence[str]) -> str:
    """ "; did you mean 'x'? known: ..." for a name that does not exist, or the new name of a renamed one."""
    now = [new for new in RENAMED.get(name, ()) if re.split(r"[.=]", new)[0] in known]
    if now:
        return f"; it is {now[0]} now" if "=" in now[0] else f"; it is called {now[0]!r} now"
    close = nearest(name, known)
    listed = ", ".join(repr(k) for k in known) or "none"
    return (f"; did you mean {close!r}?" if close else ";") + f" known: {listed}"


def nearest(name: object, known: Iterable[str]) -> str:
    """The known name that is most like `name`; "" where none is."""
    return next(iter(get_close_matches(str(name), list(known), n=1)), "")


def no_attribute(module: str, known: Sequence[str]) -> Callable[[str], NoReturn]:
    """The `__getattr__` of a public module: the error for a name that it does not have, with the nearest that it
    has."""

    def missing(name: str) -> NoReturn:
        hint = "" if name.startswith("_") else suggestion(name, known)
        raise AttributeError(f"module {module!r} has no attribute {name!r}{hint}")

    return missing
