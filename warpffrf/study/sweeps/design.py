"""The rows of a sweep: the value of each parameter in each run."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.study.sweeps.parameters import MOST_ROWS, Parameter, parameters_of, sampled

GIVEN = "as given"

Row = dict[str, Any]


@dataclass(frozen=True)
class Design:
    """`rows`, each with a value per parameter; `texts`: descriptions of the parameters; and how they were combined."""

    rows: list[Row]
    texts: dict[str, str]
    sample: str = ""
    seed: int = 0
    sizes: dict[str, int] = field(default_factory=dict)  # of a grid

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return list(self.texts)

    def digest(self) -> str:
        """sha256 of all values, which identifies the design."""
        text = json.dumps([[row[name] for name in self.names] for row in self.rows])
        return hashlib.sha256(text.encode()).hexdigest()


def design_of(parameters: Any, sample: str | None) -> Design:
    """All combinations of the `parameters`, the first varied slowest, a `sample` of them, or given rows. Raises
    `InputError`."""
    seed = 0
    if str(sample).count(":") == 2:
        sample, _, number = str(sample).rpartition(":")
        if not number.isdecimal():
            raise InputError(f"sweep: sample '{sample}:{number}': the seed must be a whole number; write {sample}:7")
        seed = int(number)
    if isinstance(parameters, Mapping):
        made = parameters_of(parameters)
        return _grid(made) if sample is None else _sample(made, sample, seed)
    if sample is not None:
        raise InputError("sweep: sample is for parameters {name: values}; rows as given are run as they are")
    return _given(parameters)


def _grid(made: dict[str, Parameter]) -> Design:
    values: dict[str, list[Any]] = {}
    for name, one in made.items():
        try:
            values[name] = one.grid()
        except InputError as error:
            raise InputError(f"sweep: parameter {name!r}: {error}") from None
    sizes = {name: len(listed) for name, listed in values.items()}
    if math.prod(sizes.values()) > MOST_ROWS:
        raise InputError(
            f"sweep: {' x '.join(map(str, sizes.values()))} combinations are more than {MOST_ROWS}; give fewer values, "
            "or a sample"
        )
    rows = [dict(zip(values, chosen, strict=True)) for chosen in itertools.product(*values.values())]
    return Design(rows, {name: one.text for name, one in made.items()}, sizes=sizes)


def _sample(made: dict[str, Parameter], sample: str, seed: int) -> Design:
    points = sampled(sample, len(made), seed)
    columns = [one.at(points[:, n]) for n, one in enumerate(made.values())]
    for name, column in zip(made, columns, strict=True):
        if not all(np.isfinite(value) for value in column if isinstance(value, float)):
            raise InputError(f"sweep: parameter {name!r}: values of its distribution are not finite; cut its ends")
    rows = [dict(zip(made, chosen, strict=True)) for chosen in zip(*columns, strict=True)]
    return Design(rows, {name: one.text for name, one in made.items()}, sample, seed)


def _given(rows: Any) -> Design:
    if hasattr(rows, "to_dict") and hasattr(rows, "columns"):  # a pandas table
        rows = rows.to_dict("records")
    if not isinstance(rows, Sequence) or isinstance(rows, str) or not rows:
        raise InputError(
            f"sweep: parameters must be {{name: values}}, or rows [{{name: value}}, ...], or a table, got {rows!r}"
        )
    if len(rows) > MOST_ROWS:
        raise InputError(f"sweep: {len(rows)} rows are more than {MOST_ROWS}; make several sweeps")
    names = list(rows[0]) if isinstance(rows[0], Mapping) else []
    found = []
    for number, row in enumerate(rows):
        if not isinstance(row, Mapping) or not row or set(row) != set(names):
            raise InputError(f"sweep: row {number} must have the parameters {', '.join(map(repr, names))}, got {row!r}")
        plain = {str(n): row[n].item() if isinstance(row[n], np.generic) else row[n] for n in names}
        for name, value in plain.items():
            if not isinstance(value, bool | int | float | str) or (isinstance(value, float) and not np.isfinite(value)):
                raise InputError(f"sweep: row {number}: {name!r} must be a finite number or a text, got {value!r}")
        found.append(plain)
    return Design(found, {str(name): GIVEN for name in names})
