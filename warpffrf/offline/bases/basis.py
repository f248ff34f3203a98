"""The common part of all bases: options, the limits of `reduce` that they accept, and their columns."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.offline.bases.modes import BasisProblem, RawBasis


@dataclass(frozen=True, kw_only=True)
class Basis(ABC):
    """Base of the bases: a frozen dataclass with a `kind`, the limits of `reduce` that it `takes`, and `columns`.

    dependent_tolerance [-]: a direction of unit energy whose part outside the others has less than this energy norm is
        dropped. Round-off of a Gram matrix, 1e-16 in its eigenvalues, is 1e-8 in a norm: smaller values keep noise.
    """

    kind: ClassVar[str] = ""
    takes: ClassVar[Mapping[str, str]] = {}  # limit of `reduce` -> its meaning here
    cure: ClassVar[str] = ""  # what to use instead of a limit that is not taken
    dependent_tolerance: float = 3e-8

    def __post_init__(self) -> None:
        self._positive("dependent_tolerance")

    def _positive(self, *names: str) -> None:
        for name in names:
            require_number(getattr(self, name), f"basis {self.kind!r}: {name}", positive=True)

    def _below_one(self, name: str) -> None:
        value = require_number(getattr(self, name), f"basis {self.kind!r}: {name}", positive=True)
        if value >= 1.0:
            raise InputError(f"basis {self.kind!r}: {name} must be below 1, got {value:g}")

    @property
    def facet_sets(self) -> tuple[str, ...]:
        """Facet sets of the mesh used by this basis."""
        return ()

    @abstractmethod
    def columns(self, problem: BasisProblem) -> RawBasis:
        """Columns that the span of the global modes of the body `problem` must contain."""

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` for a limit of `reduce`, `max_frequency` [Hz] or `modes`, that this basis does not
        accept."""
        for name, value in (("max_frequency", max_frequency), ("modes", modes)):
            if value is not None and name not in self.takes:
                raise InputError(f"basis {self.kind!r} does not use {name}; {self.cure}")

    def describe(self) -> dict[str, Any]:
        """Plain data that identifies this basis: JSON, for provenance and the cache. Arrays by their hash."""
        found: dict[str, Any] = {"kind": self.kind}
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                digest = hashlib.sha256(np.ascontiguousarray(value).data).hexdigest()
                value = {"shape": list(value.shape), "sha256": digest}
            found[field.name] = list(value) if isinstance(value, tuple) else value
        return found


@dataclass(frozen=True, kw_only=True)
class ModalBasis(Basis):
    """Bases made of vibration modes. mode_tolerance: residual of an accepted mode, of its eigenvalue; 1e-11 gives
    eigenvectors to about 1e-9 for neighbours 1 % apart."""

    mode_tolerance: float = 1e-11

    def __post_init__(self) -> None:
        super().__post_init__()
        self._positive("mode_tolerance")
