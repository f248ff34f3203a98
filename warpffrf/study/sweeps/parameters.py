"""Parameters of a sweep: a list of values, a range, or a distribution.

    [0.1, 0.2, 0.3]               values of any type that the scene accepts
    "1000:5000:5"                 a range: first, last and count, evenly spaced
    "log:1e-3:1:4"                the same in equal ratios (logarithmic)
    "normal(0.1, 0.02)"           mean and standard deviation
    "uniform(0.1, 0.3)"           least and largest
    "triangular(0.1, 0.2, 0.4)"   least, most likely and largest
    "lognormal(0.1, 0.5)"         median, and standard deviation of the logarithm

or any distribution of scipy.stats with its parameters, `scipy.stats.weibull_min(1.5)`. Texts that look like a range or
numbers must be quoted on a command line, "'A:1', 'A:2'", else they are refused.

A parameter provides its values for a grid, and the value at a probability u in (0, 1) for a sample: for a distribution
the value with cumulative probability u, for a range the point at u between its ends, for a list of n values number
floor(n u).

Samples. Points of the unit cube for a sample of a sweep; a new kind is a function here and a line in `SAMPLES`.

latin      Latin hypercube: each parameter is evenly distributed (McKay, Beckman and Conover, 1979)
sobol      Sobol's sequence, scrambled: all parameters together are evenly distributed; best for powers of two
random     independent points, for tolerances
saltelli   for Sobol indices: N points A, N points B, and for each parameter A with its column from B (Saltelli and
           others, 2010), N (d + 2) rows in this order
"""

from __future__ import annotations

import inspect
import logging
import re
import tomllib
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from warpffrf.model.errors import InputError, require_count, unknown_name

EVEN, RATIOS = "", "log"
MEANT = (RATIOS, "lin")  # prefixes of a range, and a common mistaken one
QUOTED = "put such a text in quotes"
QUOTE, SEPARATED = re.compile("['\"]"), re.compile(r"[;\s]+")
WHOLE = re.compile(r"[+-]?\d+")
CALL = re.compile(r"\s*(\w+)\s*\((.*)\)\s*")


def normal(mean: float, deviation: float) -> Any:
    """The normal distribution."""
    _positive("normal", "deviation", deviation)
    return _scipy_stats().norm(mean, deviation)


def uniform(least: float, largest: float) -> Any:
    """Uniform between two values."""
    _positive("uniform", "largest less least", largest - least)
    return _scipy_stats().uniform(least, largest - least)


def triangular(least: float, likeliest: float, largest: float) -> Any:
    """Triangular with its peak at the most likely value."""
    _positive("triangular", "largest less least", largest - least)
    if not least <= likeliest <= largest:
        raise InputError(f"triangular: likeliest {likeliest:g} is not between {least:g} and {largest:g}")
    return _scipy_stats().triang((likeliest - least) / (largest - least), least, largest - least)


def lognormal(median: float, deviation: float) -> Any:
    """A positive value with normally distributed logarithm."""
    _positive("lognormal", "median", median)
    _positive("lognormal", "deviation", deviation)
    return _scipy_stats().lognorm(deviation, scale=median)


def _scipy_stats() -> Any:
    """The module, which takes half a second to load and is not needed by workers."""
    import scipy.stats

    return scipy.stats


DISTRIBUTIONS: dict[str, Callable[..., Any]] = {
    made.__name__: made for made in (normal, uniform, triangular, lognormal)
}


def _positive(name: str, what: str, value: float) -> None:
    if not value > 0.0:
        raise InputError(f"{name}: {what} must be greater than zero, got {value:g}")


class Parameter(Protocol):
    """One parameter."""

    @property
    def text(self) -> str:
        """Its description, in input syntax."""
        ...

    def grid(self) -> list[Any]:
        """Its values for all combinations. Raises `InputError` if it has none."""
        ...

    def at(self, u: np.ndarray) -> list[Any]:
        """Its values at probabilities `u` (n,)."""
        ...


@dataclass(frozen=True)
class Listed:
    """List of values."""

    values: tuple[Any, ...]

    @property
    def text(self) -> str:
        """Description in input syntax."""
        return ", ".join(map(str, self.values))

    def grid(self) -> list[Any]:
        """The values."""
        return list(self.values)

    def at(self, u: np.ndarray) -> list[Any]:
        """All values with equal probability."""
        return [self.values[min(int(x * len(self.values)), len(self.values) - 1)] for x in u]


@dataclass(frozen=True)
class Range:
    """`count` values from `first` to `last`, evenly spaced or in equal `ratios`; `count` None: for samples only."""

    text: str
    first: float
    last: float
    count: int | None
    ratios: bool
    whole: bool  # the ends were given without a decimal point

    def grid(self) -> list[Any]:
        """The values, including both ends; integers if the ends were and all are."""
        if self.count is None:
            raise InputError(f"a range {self.text!r} has no number of values; write {self.text}:5, or give sample=")
        found = self._between(np.linspace(0.0, 1.0, self.count))
        found[0], found[-1] = self.first, self.last if self.count > 1 else self.first
        if self.whole and all(value == round(value) for value in found):
            return [int(round(value)) for value in found]
        return found

    def at(self, u: np.ndarray) -> list[Any]:
        """The points at `u` between the ends."""
        return self._between(u)

    def _between(self, u: np.ndarray) -> list[float]:
        if self.ratios:
            return (self.first * (self.last / self.first) ** u).tolist()
        return (self.first + (self.last - self.first) * u).tolist()


@dataclass(frozen=True)
class Distributed:
    """A distribution of scipy.stats: `ppf` is the inverse of its cumulative probability."""

    text: str
    distribution: Any

    def grid(self) -> list[Any]:
        """Raises: a distribution has no grid values."""
        raise InputError(f"{self.text} is a distribution; give sample='latin:64' (--sample latin:64)")

    def at(self, u: np.ndarray) -> list[Any]:
        """The values at these probabilities."""
        return np.asarray(self.distribution.ppf(u), dtype=float).tolist()


def parameter(name: str, given: Any) -> Parameter:
    """The parameter called `name`, given in one of the forms of the module. Raises `InputError` naming it."""
    try:
        return _parameter(given)
    except InputError as error:
        raise InputError(f"sweep: parameter {name!r}: {error}") from None


def parameters_of(given: Mapping[str, Any]) -> dict[str, Parameter]:
    """All of them, name -> parameter. Raises `InputError`."""
    if not given:
        raise InputError("sweep: no parameter is given; give {name: values}, with --vary NAME=VALUES on a command line")
    return {str(name): parameter(str(name), value) for name, value in given.items()}


def _parameter(given: Any) -> Parameter:
    if isinstance(given, str):
        return _of_text(given)
    if hasattr(given, "ppf"):
        return Distributed(_told(given), given)
    if isinstance(given, np.ndarray):
        given = given.tolist()
    if not isinstance(given, Sequence) or not len(given):
        raise InputError(f"must be a list of values, a range 'first:last:count' or a distribution, got {given!r}")
    values = [value.item() if isinstance(value, np.generic) else value for value in given]
    for value in values:
        if not isinstance(value, bool | int | float | str):
            raise InputError(f"a value must be a number, a text, True or False, got {value!r}")
        if isinstance(value, float) and not np.isfinite(value):
            raise InputError(f"a value must be finite, got {value!r}")
    if len({(type(value), value) for value in values}) < len(values):
        raise InputError(f"has a value twice: {', '.join(map(str, values))}")
    return Listed(tuple(values))


def _of_text(text: str) -> Parameter:
    call = CALL.fullmatch(text)
    if call:
        return _distribution(text, call[1], call[2])
    parts = [part.strip() for part in text.split(":")]
    ratios = parts[0] == RATIOS
    ends = parts[1:] if ratios else parts
    if len(ends) in (2, 3) and all(map(_number, ends[:2])):
        return _range(text, ends, ratios)
    values = values_of(text)
    _refuse_mistyped(text, parts, values)
    return Listed(tuple(_parameter(values).grid()))


def _refuse_mistyped(text: str, parts: Sequence[str], values: Sequence[Any]) -> None:
    """Raise `InputError` for values meant as a range or as numbers. Such texts must be quoted."""
    numbers = sum(map(_number, parts))
    if len(parts) > 1 and (parts[0] in MEANT or (numbers and numbers >= len(parts) - 1)):
        raise InputError(f"{text!r} is no range 'first:last:count' or 'log:first:last:count'; {QUOTED}")
    if "" in values:
        raise InputError(f"{text!r} has an empty value between commas; remove a comma")
    if not QUOTE.search(text):
        for value in values:
            several = SEPARATED.split(value) if isinstance(value, str) else []
            if len(several) > 1 and all(map(_number, several)):
                raise InputError(f"{value!r} is no number; put a comma between values; {QUOTED}")


def values_of(text: str) -> list[Any]:
    """`0.1,0.2,0.3` as values: numbers and booleans as in TOML, else texts."""
    try:
        return list(tomllib.loads(f"v = [{text}]")["v"])
    except tomllib.TOMLDecodeError:
        return [value.strip() for value in text.split(",")]


def _number(text: str) -> bool:
    try:
        return bool(np.isfinite(float(text)))
    except ValueError:
        return False


def _range(text: str, ends: list[str], ratios: bool) -> Range:
    first, last = float(ends[0]), float(ends[1])
    if ratios and (first <= 0.0 or last <= 0.0):
        raise InputError(f"range {text!r} is in equal ratios; its ends must be greater than zero")
    if first == last:
        raise InputError(f"range {text!r} has equal ends; write 'first:last:count'")
    count = None
    if len(ends) == 3:
        count = require_count(ends[2] if not _number(ends[2]) else float(ends[2]), f"the number in range {text!r}", 2)
    return Range(text, first, last, count, ratios, all(WHOLE.fullmatch(end) for end in ends[:2]))


def _distribution(text: str, name: str, numbers: str) -> Distributed:
    if name not in DISTRIBUTIONS:
        raise unknown_name("distribution", name, DISTRIBUTIONS)
    parts = [part.strip() for part in numbers.split(",")]
    for part in parts:
        if not _number(part):
            raise InputError(f"{text!r}: {part!r} is no number")
    try:
        return Distributed(text, DISTRIBUTIONS[name](*map(float, parts)))
    except TypeError:
        names = DISTRIBUTIONS[name].__code__.co_varnames[: DISTRIBUTIONS[name].__code__.co_argcount]
        raise InputError(f"{text!r}: write {name}({', '.join(names)})") from None


def _told(distribution: Any) -> str:
    """A distribution of scipy.stats with its parameters, as text."""
    kind = getattr(getattr(distribution, "dist", distribution), "name", type(distribution).__name__)
    numbers = [str(value) for value in getattr(distribution, "args", ())]
    numbers += [f"{key}={value}" for key, value in getattr(distribution, "kwds", {}).items()]
    return f"scipy.stats.{kind}({', '.join(numbers)})"


MOST_ROWS = 1_000_000  # of a sweep: its table is built in memory

log = logging.getLogger("warpffrf")


def latin(count: int, dimensions: int, seed: int) -> np.ndarray:
    """(count, dimensions)."""
    from scipy.stats import qmc

    return qmc.LatinHypercube(dimensions, **_drawn_with(qmc.LatinHypercube, seed)).random(count)


def sobol(count: int, dimensions: int, seed: int) -> np.ndarray:
    """(count, dimensions)."""
    from scipy.stats import qmc

    if count & (count - 1):
        log.warning("sweep: a Sobol sample of %d points is less evenly distributed than one of a power of two", count)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="The balance properties")  # stated in the documentation
        return qmc.Sobol(dimensions, **_drawn_with(qmc.Sobol, seed)).random(count)


def random(count: int, dimensions: int, seed: int) -> np.ndarray:
    """(count, dimensions)."""
    return np.random.default_rng(seed).random((count, dimensions))


def saltelli(count: int, dimensions: int, seed: int) -> np.ndarray:
    """(count (dimensions + 2), dimensions)."""
    both = sobol(count, 2 * dimensions, seed)
    A, B = both[:, :dimensions], both[:, dimensions:]
    mixed = []
    for column in range(dimensions):
        AB = A.copy()
        AB[:, column] = B[:, column]
        mixed.append(AB)
    return np.concatenate([A, B, *mixed])


def _drawn_with(kind: Any, seed: int) -> dict[str, Any]:
    """The seed as a keyword argument of the installed SciPy version."""
    name = "rng" if "rng" in inspect.signature(kind).parameters else "seed"
    return {name: np.random.default_rng(seed)}


SAMPLES: dict[str, Callable[[int, int, int], np.ndarray]] = {
    made.__name__: made for made in (latin, sobol, random, saltelli)
}


def sampled(sample: str, dimensions: int, seed: int) -> np.ndarray:
    """The points (n, dimensions) in (0, 1) of a sample such as "latin:64". Raises `InputError` for another text."""
    kind, colon, number = str(sample).partition(":")
    if kind not in SAMPLES:
        raise unknown_name("sweep: sample", kind, SAMPLES)
    if not colon or not number.isdecimal() or int(number) < 1:
        raise InputError(f"sweep: sample {sample!r} has no number of points; write {kind}:64")
    count, rows = int(number), int(number)
    if kind == saltelli.__name__:
        rows = count * (dimensions + 2)
        if count & (count - 1):
            power = 1 << (count - 1).bit_length()
            raise InputError(f"sweep: sample {sample!r}: Sobol indices need a power of two; write {kind}:{power}")
    if rows > MOST_ROWS:
        raise InputError(f"sweep: sample {sample!r} has {rows} rows, more than {MOST_ROWS}; make several sweeps")
    points = SAMPLES[kind](count, dimensions, seed)
    tiny = np.finfo(float).eps  # an unbounded distribution is infinite at 0 and 1
    return np.clip(points, tiny, 1.0 - tiny)
