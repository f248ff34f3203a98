"""Which space the global modes of a reduced body are taken from: one small description per basis, in one registry.

A basis is given to `reduce` by name, `basis="krylov"`, or with options, `basis=bases.Krylov(moments=3)`.
Whatever the basis, the attachment modes of the interfaces are put first, so that the static response to interface loads
is exact and the local modes never move an interface, and the union is orthonormalised by the same code
(`warpffrf.offline.bases`). `reduce`'s limits `max_frequency` and `modes` mean something else to each basis; `takes`
says what, and a limit that means nothing to a basis is refused.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number, unknown_name
from warpffrf.model.messages.named_arguments import named_arguments

__all__ = [
    "BASES",
    "Balanced",
    "Basis",
    "CraigBampton",
    "CraigChang",
    "FreeFree",
    "Krylov",
    "POD",
    "TrialVectorDerivatives",
]


def __dir__() -> list[str]:
    return __all__


@dataclass(frozen=True, kw_only=True)
class Basis:
    """Common to all bases.

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
        """Facet sets of the mesh that this basis looks at."""
        return ()

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` for a limit of `reduce`, `max_frequency` [Hz] or `modes`, that this basis does not
        take."""
        for name, value in (("max_frequency", max_frequency), ("modes", modes)):
            if value is not None and name not in self.takes:
                raise InputError(f"basis {self.kind!r} has no use for {name}; {self.cure}")

    def describe(self) -> dict[str, Any]:
        """Plain data that tells this basis from any other: JSON, for provenance and the cache. Arrays by their hash."""
        found: dict[str, Any] = {"kind": self.kind}
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                digest = hashlib.sha256(np.ascontiguousarray(value).data).hexdigest()
                value = {"shape": list(value.shape), "sha256": digest}
            found[field.name] = list(value) if isinstance(value, tuple) else value
        return found


@dataclass(frozen=True, kw_only=True)
class _Modal(Basis):
    """Bases made of vibration modes. mode_tolerance: residual of an accepted mode, of its eigenvalue; 1e-11 gives
    eigenvectors to about 1e-9 for neighbours 1 % apart."""

    mode_tolerance: float = 1e-11

    def __post_init__(self) -> None:
        super().__post_init__()
        self._positive("mode_tolerance")


@named_arguments
@dataclass(frozen=True, kw_only=True)
class FreeFree(_Modal):
    """Vibration modes of the free body (interfaces free to move) and inertia-relief attachment modes: the default."""

    kind: ClassVar[str] = "free_free"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "highest vibration mode",
        "modes": "number of vibration modes",
    }


@named_arguments
@dataclass(frozen=True, kw_only=True)
class CraigBampton(_Modal):
    """Vibration modes of the body with all interfaces held, and constraint modes (Craig and Bampton 1968)."""

    kind: ClassVar[str] = "craig_bampton"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "highest fixed-interface mode",
        "modes": "number of fixed-interface modes",
    }


@named_arguments
@dataclass(frozen=True, kw_only=True)
class CraigChang(_Modal):
    """Free vibration modes and residual-flexibility attachment modes (Craig and Chang 1977; Rubin 1975)."""

    kind: ClassVar[str] = "craig_chang"
    takes: ClassVar[Mapping[str, str]] = FreeFree.takes


@named_arguments
@dataclass(frozen=True, kw_only=True)
class Krylov(Basis):
    """Moment matching: block Krylov spaces of the interface loads about `expansion_points` [Hz] (B. Salimbahrami and B.
    Lohmann 2006).

    expansion_points: frequencies where the interface receptance and its derivatives are matched. None: 0 and, where
        `max_frequency` is given, half of it and the whole.
    moments: blocks of vectors a point; m of them match the receptance and its first 2 m - 1 derivatives with respect
        to the square of the frequency. The space has up to (points x moments x interface loads) directions.
    deflation_tolerance: a vector of unit M-norm whose part outside the space so far is smaller ends its sequence.
    Raises `InputError`.
    """

    kind: ClassVar[str] = "krylov"
    takes: ClassVar[Mapping[str, str]] = {"max_frequency": "highest of the default expansion points"}
    cure: ClassVar[str] = "its size is set by bases.Krylov(expansion_points=..., moments=...)"
    expansion_points: tuple[float, ...] | None = None
    moments: int = 2
    deflation_tolerance: float = 1e-8

    def __post_init__(self) -> None:
        super().__post_init__()
        self._positive("deflation_tolerance")
        object.__setattr__(self, "moments", require_count(self.moments, "basis 'krylov': moments", 1))
        if self.expansion_points is not None:
            name = "basis 'krylov': expansion point [Hz]"
            points = tuple(require_number(f, name, non_negative=True) for f in self.expansion_points)
            if not points or len(set(points)) != len(points):
                raise InputError(f"basis 'krylov': expansion points {points} must be distinct, and at least one")
            object.__setattr__(self, "expansion_points", points)

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` for `modes`, and for `max_frequency` beside expansion points of one's own."""
        super().check_limits(max_frequency, modes)
        if max_frequency is not None and self.expansion_points is not None:
            raise InputError("basis 'krylov': max_frequency only sets default expansion points; give one or the other")


@named_arguments
@dataclass(frozen=True, kw_only=True)
class Balanced(_Modal):
    """Balanced truncation of the second-order system from interface loads to interface motion (position-velocity
    balancing, Reis and Stykel 2008), carried out in a large space of vibration and attachment modes, the pool.

    damping: ratio of every mode of the pool; the energies that are balanced are finite only with damping.
    pool_modes: vibration modes of the pool. None: all up to twice `max_frequency`, or 200.
    tolerance: where `modes` is not given, directions are taken until twice the sum of the discarded Hankel values, the
        bound of first-order balanced truncation, is below this fraction of the largest response.
    """

    kind: ClassVar[str] = "balanced"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "half the highest vibration mode of the pool",
        "modes": "number of balanced directions",
    }
    damping: float = 0.01
    pool_modes: int | None = None
    tolerance: float = 1e-3

    def __post_init__(self) -> None:
        super().__post_init__()
        self._below_one("damping")
        self._positive("tolerance")
        if self.pool_modes is not None:
            object.__setattr__(self, "pool_modes", require_count(self.pool_modes, "basis 'balanced': pool_modes", 1))

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` for `max_frequency` [Hz] beside `pool_modes`, whatever `modes` is."""
        super().check_limits(max_frequency, modes)
        if max_frequency is not None and self.pool_modes is not None:
            raise InputError("basis 'balanced': max_frequency and pool_modes both set the pool; give one of them")


@named_arguments
@dataclass(frozen=True, kw_only=True, eq=False)
class POD(Basis):
    """Proper orthogonal decomposition of snapshots (L. Sirovich 1987), in the inner product of the mass matrix.

    snapshots: displacements (nodes, 3, t) or (3 nodes, t) [m], mesh frame and numbering, small; rigid motion is taken
        out. None: steady responses of the FE model to harmonic loads on the interfaces at `frequencies`.
    frequencies: [Hz], of the default snapshots. None: 20, evenly from 0 to `max_frequency`.
    damping: ratio of the structural damping in the default snapshots, K (1 + 2 i damping).
    tolerance: where `modes` is not given, vectors are taken until the rest is below this fraction of all snapshots
        (root of the sum of squares, mass norm). Raises `InputError`.
    """

    kind: ClassVar[str] = "pod"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "highest frequency of the default snapshots",
        "modes": "number of POD vectors",
    }
    snapshots: np.ndarray | None = None
    frequencies: tuple[float, ...] | None = None
    damping: float = 0.01
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        super().__post_init__()
        self._below_one("damping")
        self._below_one("tolerance")
        if self.snapshots is not None:
            if self.frequencies is not None:
                raise InputError("basis 'pod': snapshots are given, frequencies have no use; give one of them")
            try:
                X = np.array(self.snapshots, dtype=np.float64)
            except (TypeError, ValueError):
                raise InputError("basis 'pod': snapshots must be an array of numbers") from None
            if X.ndim == 3 and X.shape[1] == 3:
                X = X.reshape(-1, X.shape[2])
            if X.ndim != 2 or len(X) % 3 or not X.size:
                raise InputError(f"basis 'pod': snapshots must have shape (nodes, 3, t) or (3 nodes, t), got {X.shape}")
            if not np.all(np.isfinite(X)):
                raise InputError("basis 'pod': snapshots hold NaN or infinite numbers")
            X.setflags(write=False)
            object.__setattr__(self, "snapshots", X)
        if self.frequencies is not None:
            name = "basis 'pod': frequency [Hz]"
            found = tuple(require_number(f, name, non_negative=True) for f in self.frequencies)
            if not found:
                raise InputError("basis 'pod': frequencies are empty; give at least one")
            object.__setattr__(self, "frequencies", found)

    def check_limits(self, max_frequency: float | None, modes: int | None) -> None:
        """Raises `InputError` where it is open, or twice said, at which frequencies snapshots are to be computed:
        `max_frequency` [Hz] or `frequencies`; modes: any number."""
        super().check_limits(max_frequency, modes)
        if max_frequency is not None and (self.snapshots is not None or self.frequencies is not None):
            raise InputError(
                "basis 'pod': max_frequency only sets the frequencies of default snapshots; leave it out here"
            )
        if max_frequency is None and self.snapshots is None and self.frequencies is None:
            raise InputError(
                "basis 'pod': give bases.POD(snapshots=...), bases.POD(frequencies=...) or max_frequency, so that it "
                "is known what responses it shall hold"
            )


@named_arguments
@dataclass(frozen=True, kw_only=True)
class TrialVectorDerivatives(_Modal):
    """Vibration modes of the free body and joint modes of two faces `first` and `second` (facet sets of the mesh) that
    touch: derivatives of static and vibration modes with respect to the state of the joint (Witteveen, Pichler 2014).

    normal, tangential: number of joint modes from pressures and from tractions. For comparison with the published way;
    a lap (`reduce(laps=...)`) knows every cell and needs no such modes. Raises `InputError`.
    """

    kind: ClassVar[str] = "trial_vector_derivatives"
    takes: ClassVar[Mapping[str, str]] = FreeFree.takes
    first: str = ""
    second: str = ""
    normal: int = 20
    tangential: int = 20

    def __post_init__(self) -> None:
        super().__post_init__()
        label = f"basis {self.kind!r}"
        for name in ("first", "second"):
            if not isinstance(getattr(self, name), str) or not getattr(self, name):
                raise InputError(
                    f"{label}: {name} must name a facet set; give bases.TrialVectorDerivatives(first=..., second=...), "
                    "the two faces of the joint"
                )
        if self.first == self.second:
            raise InputError(f"{label}: first and second are both {self.first!r}; name the two faces of the joint")
        for name in ("normal", "tangential"):
            object.__setattr__(self, name, require_count(getattr(self, name), f"{label}: {name}", 0))

    @property
    def facet_sets(self) -> tuple[str, ...]:
        """The two faces."""
        return self.first, self.second


BASES: dict[str, type[Basis]] = {
    cls.kind: cls for cls in (FreeFree, CraigBampton, CraigChang, Krylov, Balanced, POD, TrialVectorDerivatives)
}


def basis_options(basis: Any) -> Basis:
    """The options behind `reduce`'s argument `basis`: a name of `BASES` or options themselves. Raises `InputError`."""
    if isinstance(basis, Basis):
        return basis
    if isinstance(basis, str) and basis in BASES:
        return BASES[basis]()
    raise unknown_name("basis", basis, BASES)
