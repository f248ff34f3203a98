r"""The deformed skin of a body at a saved step, and the pressure on it.

    x_user = X + Phi_g(X) q + Theta(q, q)(X) + recover(f) + sum_i matched_i(X) s_i

Theta is the second-order motion of bodies with membrane energy and stiffening (`model.second_order_motion`). `recover`
is the local modes' response to outward nodal forces, those of `normal_loads`; with friction the tangential forces of
`patch_on_skin` are recovered in the same way, for bodies reduced with tangential modes. Oil films load their first body
by their pressure; their shear is neglected. sum_i matched_i s_i is the local response to the forces s on the cells
of small-sliding contacts (`small_sliding_loads`); if it is too large for a body's file, results state that it is
missing (`small_sliding_loads.left_out`). Pressure, traction and state of small-sliding contacts are those of
`faces_on_skin`. Slip speed and wear are those of other contacts: small-sliding contacts have slip distances, in
`result.contact(name)`. Stress is that of `skin_stress`, if the body was reduced with it.
A gear whose flanks are half-spaces has the skin of a whole gear, `geometry.gear_body`.

Skin stress. Stress at the nodes of a skin, for bodies reduced with stress points there.

`reduce(..., stress={"skin": "skin"})` selects all nodes of the skin, a facet set or a list of points only its own. A
node takes its stress from the points at its position. Nodes of coincident faces share a position: there nodes and
points are matched in their order, and a position where their numbers differ has no stress, because the match is
ambiguous. Nodes without points are NaN, which viewers do not draw.

Shown skin. The skin of a body as drawn in pictures and recordings: thinned, coloured by one field.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.reduced.inertia import skin_displacement
from warpffrf.model.reduced.stress_field import von_mises
from warpffrf.output.bodies.normal_loads import SmallSlidingLoads, faces_on_skin, film_loads, normal_loads
from warpffrf.output.bodies.patch_on_skin import PatchOnSkin, patch_on_skin, tangential_forces
from warpffrf.output.bodies.stress import BodyStress
from warpffrf.output.geometry.gear_body import half_space_gear
from warpffrf.output.geometry.places import SkinSurface
from warpffrf.output.geometry.reference import Reference
from warpffrf.output.geometry.scene_view import BodyView, PairView, SceneView
from warpffrf.output.geometry.skin_nodes import thinned

CONTACT_FIELDS = ("pressure", "traction", "slip", "state", "wear")  # fields of contacts on a skin
SMALL_SLIDING_FIELDS = ("pressure", "traction", "state")  # fields of small-sliding contacts on a skin
VON_MISES = "von_mises"  # for bodies reduced with stress points on their skin


class Skin:
    """The skin of one flexible body over a run: displacement, pressure and stress at saved step `i`."""

    def __init__(self, history: Any, view: SceneView, body: BodyView) -> None:
        self.history = history
        self.body = body
        gear = half_space_gear(view, body)
        self.is_rigid = gear is not None  # a gear on half-spaces, drawn whole
        surface = body.reduced.surface if gear is None else gear
        self.points = np.asarray(surface.points, dtype=float)  # (n, 3) m, user frame, undeformed
        self.triangles = np.asarray(surface.triangles)  # (t, 3)
        self._pairs = [p for p in view.pairs.values() if body.name in (p.first_body.name, p.second_body.name)]
        self._on = {p.name: SkinSurface(self._surface(p), self.points) for p in self._pairs}
        self._loads = {p.name: normal_loads(p, history, first=self._is_first(p)) for p in self._pairs}
        films = film_loads(view.films.values(), history, body.name)
        self._films = [(load, SkinSurface(load.surface, self.points)) for load in films]
        self._small_sliding_loads = SmallSlidingLoads(history, view, body.name)
        self._small_sliding = faces_on_skin(history, view, body.name, self.points, self.triangles)
        self._rubbing = {
            p.name: patch_on_skin(p, history, self._on[p.name], self.points, first=self._is_first(p))
            for p in self._pairs
            if getattr(history.contacts[p.name], "friction", None) is not None
        }
        self.stress = SkinStress(history, view, body.name, self.points)

    def _is_first(self, pair: PairView) -> bool:
        return pair.first_body.name == self.body.name

    def _surface(self, pair: PairView) -> Any:
        return pair.first if self._is_first(pair) else pair.second

    def displacement(self, i: int) -> np.ndarray:
        """Elastic displacement (n, 3) [m] in user axes at saved step `i`."""
        if self.is_rigid:
            return np.zeros_like(self.points)
        q = self.history.bodies[self.body.name].modal[i]
        u = skin_displacement(self.body, q)
        for pair in self._pairs:
            forces = self._loads[pair.name].forces(i)
            if np.any(forces):
                u = u + self._surface(pair).recover(forces)
            tangential = self._surface(pair).tangential
            if pair.name in self._rubbing and tangential is not None:
                contact, first = self.history.contacts[pair.name], self._is_first(pair)
                u = u + tangential.recover(tangential_forces(pair, contact, self.history.bodies, i, first=first))
        for load, _ in self._films:
            u = u + load.surface.recover(load.forces(i))
        on_faces, responses = self._small_sliding_loads.forces(i), self.body.reduced.surface.matched
        if on_faces is not None and responses is not None:
            u = u + np.tensordot(on_faces.astype(responses.dtype), responses, axes=1)
        return u

    def pressure(self, i: int) -> np.ndarray:
        """Pressure (n,) [Pa] of contacts, oil films and small-sliding contacts at the skin's nodes, zero outside of
        their surfaces, at saved step `i`."""
        p = np.zeros(len(self.points))
        for pair in self._pairs:
            on = self._on[pair.name]
            p[on.nodes] += self._loads[pair.name].pressure(i, on, self.points)
        for load, on in self._films:
            p[on.nodes] += load.pressure(i, on, self.points)
        for face in self._small_sliding:
            p += face.pressure(i)
        return p

    @property
    def contact_fields(self) -> tuple[str, ...]:
        """Those of `CONTACT_FIELDS` that this body has: only pressure without friction, for small-sliding contacts with
        friction no slip speed and wear, none without contact or oil film."""
        if self._rubbing:
            return CONTACT_FIELDS
        if any(face.rubs for face in self._small_sliding):
            return SMALL_SLIDING_FIELDS
        return CONTACT_FIELDS[:1] if self._pairs or self._films or self._small_sliding else ()

    def traction(self, i: int) -> np.ndarray:
        """Tangential traction (n, 3) [Pa] on this body at the skin's nodes, user axes, at saved step `i`."""
        parts = [on.traction(i) for on in (*self._rubbing.values(), *self._small_sliding)]
        return np.sum(parts, axis=0) if parts else np.zeros_like(self.points)

    def slip_speed(self, i: int) -> np.ndarray:
        """Slip speed (n,) [m/s] at the skin's nodes, zero outside of the patches, at saved step `i`."""
        return self._of_patches(i, lambda p: np.linalg.norm(p.contact.friction.slip_velocity[i], axis=0))

    def wear(self, i: int) -> np.ndarray:
        """Wear index (n,) [W/m2], pressure times slip speed, at the skin's nodes at saved step `i`."""
        return self.pressure(i).clip(min=0.0) * self.slip_speed(i)

    def state(self, i: int) -> np.ndarray:
        """State (n,) of the cell that contains each of the skin's nodes, for small-sliding contacts of the cells around
        it: 0 open, 1 stick, 2 slip; at saved step `i`."""
        found = np.zeros(len(self.points), dtype=np.int8)
        for patch in self._rubbing.values():
            found = np.maximum(found, patch.nearest(i, patch.contact.friction.state[i]).astype(np.int8))
        for face in self._small_sliding:
            found = np.maximum(found, face.state(i))
        return found

    @property
    def fields(self) -> tuple[str, ...]:
        """Fields of this body's skin in addition to its displacement: `contact_fields`, and "von_mises" if the body was
        reduced with stress points on it."""
        return (*self.contact_fields, *([VON_MISES] if self.stress.count else []))

    def field(self, name: str, i: int) -> np.ndarray:
        """One of `fields` (n,) at saved step `i`, as `contact_field`; von Mises [Pa] is NaN without a stress point.
        Raises `InputError` for one that this body does not have."""
        if name == VON_MISES and self.stress.count:
            return self.stress.von_mises(i)
        return self.contact_field(name, i)

    def contact_field(self, name: str, i: int) -> np.ndarray:
        """One of `contact_fields` (n,) at saved step `i`, the magnitude of the traction; SI units. Raises `InputError`
        for one that this body does not have."""
        if name not in self.contact_fields:
            raise unknown_name(f"body '{self.body.name}': contact field", name, list(self.contact_fields))
        if name == "traction":
            return np.linalg.norm(self.traction(i), axis=1)
        found = {"pressure": self.pressure, "slip": self.slip_speed, "state": self.state, "wear": self.wear}[name]
        return found(i)

    def _of_patches(self, i: int, window: Callable[[PatchOnSkin], np.ndarray]) -> np.ndarray:
        found = np.zeros(len(self.points))
        for patch in self._rubbing.values():
            found = np.maximum(found, patch.scalar(i, window(patch)))
        return found


SAME = 1e-9  # of the extent of a skin: closer positions are equal
CURE = "reduce(..., stress={'skin': 'skin'}) gives it"


class SkinStress:
    """Stress at the nodes `points` (n, 3) [m, user frame] of the skin of the body called `body`."""

    def __init__(self, history: Any, view: SceneView, body: str, points: np.ndarray) -> None:
        self.history, self.view, self.body, self.points = history, view, body, points

    @cached_property
    def _parts(self) -> list[tuple[str, np.ndarray, np.ndarray]]:
        """For each name of stress points that is needed: the nodes with stress from it, and the indices of their
        points."""
        free, found = np.ones(len(self.points), dtype=bool), []
        fields = {} if self.view.expands(self.body) else self.view.bodies[self.body].reduced.stress
        matches = {name: same_places(self.points, field.points) for name, field in fields.items()}
        for name, match in sorted(matches.items(), key=lambda item: -np.count_nonzero(item[1] >= 0)):
            nodes = np.flatnonzero(free & (match >= 0))
            if len(nodes):
                found.append((name, nodes, match[nodes]))
                free[nodes] = False
        return found

    @cached_property
    def _sources(self) -> list[BodyStress]:
        return [BodyStress(self.history, self.view, self.body, name) for name, _, _ in self._parts]

    @property
    def count(self) -> int:
        """Number of skin nodes with stress."""
        return sum(len(nodes) for _, nodes, _ in self._parts)

    @property
    def note(self) -> str:
        """Text on missing stresses and the remedy; empty if every node has its stress."""
        whole = len(self.points)
        if self.view.expands(self.body):
            return f"body '{self.body}' has a thermal load, with which its stress is not known"
        if self.count == whole:
            return ""
        part = f"stress at {self.count} of {whole} nodes of its skin" if self.count else "no stress on its skin"
        return f"body '{self.body}' has {part}; {CURE}"

    def tensor(self, i: int) -> np.ndarray:
        """Stress (n, 6) [Pa] in the order xx, yy, zz, xy, yz, zx, user axes, at saved step `i`; NaN if unknown."""
        found = np.full((len(self.points), 6), np.nan)
        for source, (_, nodes, points) in zip(self._sources, self._parts, strict=True):
            found[nodes] = source.tensor(i)[points]
        return found

    def von_mises(self, i: int) -> np.ndarray:
        """Equivalent stress (n,) [Pa] at saved step `i`; NaN if unknown."""
        return von_mises(self.tensor(i))


def same_places(nodes: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Indices (n,) of the `points` (p, 3) [m] at each of `nodes` (n, 3) [m], -1 for none."""
    found = np.full(len(nodes), -1)
    if nodes.shape == points.shape and np.array_equal(nodes, points):
        return np.arange(len(nodes))
    if not len(nodes) or not len(points):
        return found
    reach = SAME * float(np.ptp(nodes, axis=0).max())
    here = KDTree(points).query_ball_point(nodes, reach, return_sorted=True)
    beside = KDTree(nodes).query_ball_point(nodes, reach, return_sorted=True)
    for n, (at, among) in enumerate(zip(here, beside, strict=True)):
        if len(at) == len(among):
            found[n] = at[among.index(n)]
    return found


DISPLACEMENT = "displacement"  # field of every flexible body


def known_fields(skins: dict[str, Skin]) -> list[str]:
    """Fields available for the skins of a run: the displacement, and those of at least one skin."""
    return [DISPLACEMENT, *dict.fromkeys(field for skin in skins.values() for field in skin.fields)]


def require_field(skins: dict[str, Skin], field: str, what: str) -> None:
    """Raises `InputError` naming `what` for a field that no skin has."""
    known = known_fields(skins)
    if field == VON_MISES and field not in known:
        notes = "; ".join(skin.stress.note for skin in skins.values())
        raise InputError(f"{what} '{VON_MISES}': {notes or 'no body is flexible'}")
    if field not in known:
        raise unknown_name(what, field, known)


class ShownSkin:
    """A skin of at most `max_points` points: `points` (n, 3) [m, user frame], `triangles` (t, 3), `size` [m], the
    largest extent of the full skin; its displacements are relative to a `reference`."""

    def __init__(self, skin: Skin, max_points: int, reference: Reference) -> None:
        sectors = max((s.recovery.sectors for s in skin.body.reduced.contact_surfaces.values()), default=1)
        self.skin, self.reference = skin, reference
        most = len(skin.points) if skin.is_rigid else max_points  # whole gears have few points
        self.kept, self.triangles = thinned(skin.points, skin.triangles, most, sectors)
        self.points = skin.points[self.kept]
        # node of the skin -> point that represents it: thinning must not lose a patch between points
        self.nearest = KDTree(self.points).query(skin.points)[1]
        self.size = float(np.ptp(skin.points, axis=0).max())

    def displacement(self, i: int) -> np.ndarray:
        """Elastic displacement (n, 3) [m] relative to the reference, user axes, at saved step `i`."""
        return self.skin.displacement(i)[self.kept] - self.carried(i)

    def carried(self, i: int) -> np.ndarray:
        """Displacement (n, 3) [m] with the reference, user axes, at saved step `i`; it is not magnified."""
        return self.reference.motion(self.skin.body.name, self.points, i)

    def values(self, field: str, i: int) -> np.ndarray:
        """One of `Skin.fields` (n,) in SI units at saved step `i`, the largest of the nodes that a point represents;
        zero for a body without the field, because it has no contact, but NaN for its stress, which is unknown."""
        found = np.full(len(self.kept), np.nan if field == VON_MISES or field in self.skin.fields else 0.0)
        if field in self.skin.fields:
            np.fmax.at(found, self.nearest, self.skin.field(field, i))
        return found
