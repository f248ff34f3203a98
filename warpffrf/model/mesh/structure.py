r"""Structural elements of a mesh: shells, beams, point masses, springs and rigid links.

Their nodes have six degrees of freedom, displacement and rotation; nodes of solid cells have three. Elements are
connected by shared nodes. A node that a shell or a beam shares with a solid transmits forces, but no moment: a shell
that ends on a row of solid nodes is hinged there (docs/structures.md describes clamped connections).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.material import Material
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.messages.named_arguments import named_arguments

SHELL_KINDS = {3: "tri3", 4: "quad4", 6: "tri6", 8: "quad8"}
ROUND_OFF = 1e-9  # of the largest second moment of a point mass

Array = np.ndarray


def _nodes(given: Any, widths: tuple[int, ...], what: str) -> Array:
    array = np.asarray(given)
    if array.ndim != 2 or array.shape[1] not in widths or not len(array) or array.dtype.kind not in "iu":
        raise InputError(
            f"{what}: nodes must be integers of shape (elements, {' or '.join(map(str, widths))}), got {array.shape} "
            f"of {array.dtype}"
        )
    ordered = np.sort(array, axis=1)
    twice = np.flatnonzero(np.any(ordered[:, 1:] == ordered[:, :-1], axis=1))
    if len(twice):
        raise InputError(f"{what}: element {twice[0]} has a node twice; mesh it with triangles, or leave it out")
    array = array.astype(np.int64)
    array.setflags(write=False)
    return array


def _material(given: Any, what: str) -> None:
    if not isinstance(given, Material):
        raise InputError(f"{what}: material must be a Material(...), got {given!r}")


@named_arguments
@dataclass(frozen=True, eq=False)
class Shell:
    """Shell elements of one thickness and material.

    nodes (m, k): positions in the mesh's `points`, k = 3, 4, 6 or 8, in the order of VTK; the order of the corners
    gives the normal by the right-hand rule, and so the top of the shell. thickness [m]; offset [m]: distance of the
    middle surface from the nodes along the normal. name: for stresses and reports. Raises `InputError` for inadmissible
    values.
    """

    nodes: Any
    thickness: float
    material: Material
    offset: float = field(default=0.0, kw_only=True)
    name: str = field(default="shell", kw_only=True)

    def __post_init__(self) -> None:
        what = f"shell {self.name!r}"
        object.__setattr__(self, "nodes", _nodes(self.nodes, tuple(SHELL_KINDS), what))
        object.__setattr__(self, "thickness", require_number(self.thickness, f"{what}: thickness", positive=True))
        object.__setattr__(self, "offset", require_number(self.offset, f"{what}: offset"))
        _material(self.material, what)

    @property
    def kind(self) -> str:
        """Kind of the facets: "tri3", "quad4", "tri6" or "quad8"."""
        return SHELL_KINDS[self.nodes.shape[1]]


@named_arguments
@dataclass(frozen=True)
class BeamSection:
    """Section of a beam in its principal axes y and z: area [m2], second moments [m4] I_y = int z^2 dA for bending in
    the plane x-z and I_z = int y^2 dA, torsion constant J [m4]; shear_y, shear_z [-]: shear factors along y and z, the
    ratio of the effective shear area (0: no shear deformation). Raises `InputError` unless the first four are positive.
    """

    area: float
    I_y: float
    I_z: float
    J: float
    shear_y: float = field(default=0.0, kw_only=True)
    shear_z: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        for name in ("area", "I_y", "I_z", "J", "shear_y", "shear_z"):
            positive = not name.startswith("shear")
            value = require_number(getattr(self, name), f"beam section: {name}", positive=positive)
            if value < 0.0:
                raise InputError(f"beam section: {name} must not be negative, got {value:g}")
            object.__setattr__(self, name, value)

    @classmethod
    def rectangle(cls, width: float, height: float) -> BeamSection:
        """Solid rectangle, `width` [m] along y and `height` [m] along z; J by the series of Saint-Venant's torsion to
        0.5 % (Young, Roark's Formulas for Stress and Strain, table 10.7). Raises `InputError` unless both are positive.
        """
        b, h = (require_number(v, "beam section: side", positive=True) for v in (width, height))
        long, short = max(b, h), min(b, h)
        ratio = short / long
        J = long * short**3 * (1.0 / 3.0 - 0.21 * ratio * (1.0 - ratio**4 / 12.0))
        return cls(b * h, b * h**3 / 12.0, h * b**3 / 12.0, J, shear_y=5.0 / 6.0, shear_z=5.0 / 6.0)

    @classmethod
    def circle(cls, radius: float, inner_radius: float = 0.0) -> BeamSection:
        """Circle or pipe of `radius` and `inner_radius` [m], shear factor after Cowper at nu = 0.3. Raises `InputError`
        for an inner radius that is not smaller."""
        R = require_number(radius, "beam section: radius", positive=True)
        r = require_number(inner_radius, "beam section: inner_radius")
        if not 0.0 <= r < R:
            raise InputError(f"beam section: inner_radius must lie in 0 to {R:g} m, got {r:g}")
        inertia = 0.25 * np.pi * (R**4 - r**4)
        m, nu = r / R, 0.3
        factor = (
            6.0 * (1.0 + nu) * (1.0 + m * m) ** 2 / ((7.0 + 6.0 * nu) * (1.0 + m * m) ** 2 + (20.0 + 12.0 * nu) * m * m)
        )
        return cls(np.pi * (R * R - r * r), inertia, inertia, 2.0 * inertia, shear_y=factor, shear_z=factor)


@named_arguments
@dataclass(frozen=True, eq=False)
class Beam:
    """Two-node Timoshenko beams of one section and material.

    nodes (m, 2); direction (3,) or (m, 3): in the plane of the beam's axis and the section's y axis, user frame, not
    parallel to the beam; offset (3,) or (m, 3) [m, user frame]: from the nodes to the centroid of the section; name:
    for reports. Raises `InputError` for inadmissible values.
    """

    nodes: Any
    section: BeamSection
    material: Material
    direction: Any
    offset: Any = field(default_factory=lambda: np.zeros(3), kw_only=True)
    name: str = field(default="beam", kw_only=True)

    def __post_init__(self) -> None:
        what = f"beam {self.name!r}"
        object.__setattr__(self, "nodes", _nodes(self.nodes, (2,), what))
        if not isinstance(self.section, BeamSection):
            raise InputError(f"{what}: section must be a BeamSection(...), got {self.section!r}")
        _material(self.material, what)
        for name in ("direction", "offset"):
            one = np.ndim(getattr(self, name)) == 1
            value = require_array(getattr(self, name), f"{what}: {name}", (3,) if one else (len(self.nodes), 3))
            object.__setattr__(self, name, np.broadcast_to(value, (len(self.nodes), 3)))
        if not np.all(np.any(self.direction, axis=1)):
            raise InputError(f"{what}: direction has zero length; give the direction of the section's y axis")


@named_arguments
@dataclass(frozen=True, eq=False)
class PointMass:
    """A mass [kg] at `node`, its centre at offset (3,) [m, user frame] from it, with the inertia tensor (3, 3) [kg m2]
    about its centre, user axes. Offset and inertia need a node with rotation: of a shell, a beam or a rigid link.
    Raises `InputError` for an inertia that no body has (a principal moment above the sum of the others)."""

    node: int
    mass: float
    inertia: Any = field(default_factory=lambda: np.zeros((3, 3)), kw_only=True)
    offset: Any = field(default_factory=lambda: np.zeros(3), kw_only=True)

    def __post_init__(self) -> None:
        what = f"point mass at node {self.node}"
        object.__setattr__(self, "node", int(self.node))
        object.__setattr__(self, "mass", require_number(self.mass, f"{what}: mass", positive=True))
        object.__setattr__(self, "offset", require_array(self.offset, f"{what}: offset", (3,)))
        J = require_array(self.inertia, f"{what}: inertia", (3, 3))
        object.__setattr__(self, "inertia", J)
        moments = self.second_moments[0]
        if not np.allclose(J, J.T, rtol=1e-9, atol=0.0) or moments[0] < -ROUND_OFF * max(moments[-1], 1e-300):
            raise InputError(
                f"{what}: no body has the inertia {J.tolist()}; it is symmetric, each moment <= the others' sum"
            )

    @property
    def second_moments(self) -> tuple[Array, Array]:
        """Principal second moments (3,) [kg m2], ascending, and their axes in columns."""
        J = 0.5 * (self.inertia + self.inertia.T)
        values, axes = np.linalg.eigh(0.5 * np.trace(J) * np.eye(3) - J)
        return values, axes


@named_arguments
@dataclass(frozen=True, eq=False)
class Spring:
    """A spring between two nodes: stiffness (6, 6) [N/m, N, N m], or its diagonal (6,), of the second node's motion
    relative to the first one at the middle between both, in `axes` (3, 3) (columns, user frame). Rotational entries,
    and lateral ones of nodes apart, need nodes with rotation. Raises `InputError` unless symmetric and semidefinite."""

    nodes: tuple[int, int]
    stiffness: Any
    axes: Any = field(default_factory=lambda: np.eye(3), kw_only=True)

    def __post_init__(self) -> None:
        pair = tuple(int(a) for a in self.nodes)
        what = f"spring at nodes {pair}"
        if len(pair) != 2 or pair[0] == pair[1]:
            raise InputError(f"{what}: two different nodes are needed; a spring to the ground belongs into the scene")
        k = np.asarray(self.stiffness, dtype=float)
        k = require_array(np.diag(k) if k.shape == (6,) else k, f"{what}: stiffness", (6, 6))
        if not np.allclose(k, k.T, rtol=1e-9) or np.linalg.eigvalsh(k)[0] < -ROUND_OFF * np.abs(k).max():
            raise InputError(f"{what}: the stiffness must be symmetric and positive semidefinite")
        axes = require_array(self.axes, f"{what}: axes", (3, 3))
        if not np.allclose(axes.T @ axes, np.eye(3), atol=1e-6):
            raise InputError(f"{what}: the columns of axes must be orthonormal")
        for name, value in (("nodes", pair), ("stiffness", k), ("axes", axes)):
            object.__setattr__(self, name, value)


@named_arguments
@dataclass(frozen=True, eq=False)
class RigidLink:
    """`nodes` (k,) that move as one rigid body, described at the first one (RBE2, *RIGID BODY, kinematic coupling).
    Rotations of the nodes are those of the link; name: for reports. Raises `InputError` for fewer than two nodes."""

    nodes: Any
    name: str = field(default="link", kw_only=True)

    def __post_init__(self) -> None:
        nodes = np.asarray(self.nodes)
        if nodes.ndim != 1 or len(np.unique(nodes)) < 2 or nodes.dtype.kind not in "iu":
            raise InputError(f"rigid link {self.name!r}: at least two different nodes are needed, got {self.nodes!r}")
        first = nodes[0]
        rest = np.setdiff1d(nodes, [first])
        object.__setattr__(self, "nodes", np.concatenate([[first], rest]).astype(np.int64))


PARTS = (Shell, Beam, PointMass, Spring, RigidLink)


@dataclass(frozen=True, eq=False)
class Structure:
    """All structural elements of a mesh, in the order given."""

    parts: tuple[Any, ...] = ()

    kinds: ClassVar[tuple[type, ...]] = PARTS

    def __post_init__(self) -> None:
        for part in self.parts:
            if not isinstance(part, PARTS):
                known = ", ".join(one.__name__ for one in PARTS)
                raise InputError(f"mesh: structure holds {part!r}; it is made of {known}")

    def of(self, kind: type) -> list[Any]:
        """The parts of one kind."""
        return [part for part in self.parts if isinstance(part, kind)]

    def nodes(self, *kinds: type) -> Array:
        """Sorted nodes of the parts of `kinds`, of all without."""
        return np.unique(
            np.concatenate([np.zeros(0, np.int64), *(_of(p) for p in self.parts if not kinds or isinstance(p, kinds))])
        )

    @property
    def rotating(self) -> Array:
        """Sorted nodes with rotations: those of shells, beams and rigid links."""
        return self.nodes(Shell, Beam, RigidLink)

    def connections(self) -> list[Array]:
        """Nodes (m, k) of elements that hold nodes together."""
        return [np.atleast_2d(np.asarray(p.nodes)) for p in self.parts if not isinstance(p, PointMass)]

    def bytes(self) -> bytes:
        """Everything that affects numbers, for hashes."""
        found = []
        for part in self.parts:
            found.append(type(part).__name__.encode())
            for name, value in vars(part).items():
                if isinstance(value, np.ndarray):
                    found += [name.encode(), value.tobytes()]
                elif isinstance(value, Material):
                    found.append(repr((value.youngs_modulus, value.poisson_ratio, value.density)).encode())
                else:
                    found.append(repr((name, value)).encode())
        return b"|".join(found)

    def renumbered(self, number: Array) -> Structure:
        """The same parts with node a called `number[a]`."""
        found = []
        for part in self.parts:
            if isinstance(part, PointMass):
                found.append(replace(part, node=int(number[part.node])))
            else:
                found.append(replace(part, nodes=number[np.asarray(part.nodes)]))
        return Structure(tuple(found))

    def split(self, wanted: Array) -> tuple[Structure, Structure]:
        """The elements whose first node is marked in `wanted` (n,), and the others."""
        sides: tuple[list[Any], list[Any]] = ([], [])
        for part in self.parts:
            if isinstance(part, Shell | Beam):
                mask = wanted[part.nodes[:, 0]]
                for side, rows in zip(sides, (mask, ~mask), strict=True):
                    if rows.any():
                        more = (
                            {}
                            if isinstance(part, Shell)
                            else {"direction": part.direction[rows], "offset": part.offset[rows]}
                        )
                        side.append(replace(part, nodes=part.nodes[rows], **more))
            else:
                sides[0 if wanted[_of(part)[0]] else 1].append(part)
        return Structure(tuple(sides[0])), Structure(tuple(sides[1]))

    def facet_sets(self) -> dict[str, FacetSet]:
        """{name of a shell: its elements} as facets."""
        found: dict[str, dict[str, Array]] = {}
        for shell in self.of(Shell):
            blocks = found.setdefault(shell.name, {})
            known = blocks.get(shell.kind, np.zeros((0, shell.nodes.shape[1]), dtype=np.int64))
            blocks[shell.kind] = np.concatenate([known, shell.nodes])
        return {name: FacetSet(blocks) for name, blocks in found.items()}

    def counts(self) -> dict[str, int]:
        """Number of elements by kind."""
        found: dict[str, int] = {}
        for part in self.parts:
            label = {Beam: "beam", PointMass: "point mass", Spring: "spring", RigidLink: "rigid link"}.get(type(part))
            label = label or f"{part.kind} shell"
            found[label] = found.get(label, 0) + (len(part.nodes) if isinstance(part, Shell | Beam) else 1)
        return found


def _rows(part: Any, rows: Array) -> Any:
    """The part with some of its elements."""
    more = {} if isinstance(part, Shell) else {"direction": part.direction[rows], "offset": part.offset[rows]}
    return replace(part, nodes=part.nodes[rows], **more)


def _of(part: Any) -> Array:
    return np.array([part.node]) if isinstance(part, PointMass) else np.asarray(part.nodes).ravel()
