"""Overlaps at the start that no small motion opens: a body wedged between its partners, or all round in a bore.

With g_k the gaps at places k of all pairs, L their gradients by the rigid coordinates z of the bodies and C those of
the joints and drives, the overlap that stays however the bodies are moved a little is -t of the linear programme

    maximise t,      g_k + L_k z >= t,      C z = 0,      |z| <= MOVED times the deepest overlap.

Its multipliers are forces at these places that hold each other in balance: the pairs that have some are those that
wedge. An overlap that a motion opens has none. Deformation takes a small wedge up, as an interference fit; a deep one
is a body in the wrong place, or of the wrong size.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linprog

from warpffrf.model.checks.redundancy import held_motions, scene_length
from warpffrf.model.placement.gap import GapSamples, Nearest, facing_gap, gap_samples

if TYPE_CHECKING:
    from warpffrf.model.contact import Contact
    from warpffrf.model.scene import Scene

MOVED = 4.0  # of the deepest overlap: further than a wedge is deep, and near enough for a linear programme
NEARER = 12.0  # of it: wider gaps stay open in such a motion of both bodies and a turn
SHALLOW = 1e-7  # of the deepest overlap: what the linear programme leaves over
TAKES_PART = 1e-6  # of all multipliers


@dataclass(frozen=True)
class Wedge:
    """The pairs that wedge, the overlap [m] that stays at each of them, and whether a single one is held on opposite
    sides of a body."""

    contacts: tuple[Contact, ...]
    depth: float
    all_round: bool

    def __str__(self) -> str:
        names = ", ".join(repr(c.name) for c in self.contacts)
        if self.all_round:
            inner, outer = sorted((p.label for p in self.contacts[0].ports), key=lambda label: label in self._hollow)
            return (
                f"contact {names}: {inner} is too large for {outer}, an overlap of {self.depth:.3g} m on opposite "
                "sides that no motion opens; change a radius, or hold bodies that are shrunk together with joints.Fixed"
            )
        if len(self.contacts) == 1:
            ports = self.contacts[0].ports
            return (
                f"contact {names}: {ports[0].label} and {ports[1].label} overlap by {self.depth:.3g} m, and joints and "
                "drives let neither give way; move one with its joint, or take a smaller interference"
            )
        return (
            f"contacts {names}: {self._middle}, an overlap of {self.depth:.3g} m at each that no small motion opens; "
            "move the partners apart, change a radius, or take a smaller interference"
        )

    @property
    def _hollow(self) -> list[str]:
        return [port.label for port in self.contacts[0].ports if port.surface.shape.side < 0.0]

    @property
    def _middle(self) -> str:
        """The body in the middle and its partners; of a longer chain all bodies."""
        ports = [port for contact in self.contacts for port in contact.ports]
        for body in (port.body for port in ports if not port.on_ground):
            if all(any(p.body is body for p in contact.ports) for contact in self.contacts):
                others = [port.label for port in ports if port.body is not body]
                return f"body {body.name!r} is wedged between {' and '.join(others)}"
        names = sorted({(port.body.index, port.body.name) for port in ports if not port.on_ground})
        return f"bodies {', '.join(repr(name) for _, name in names)} are wedged in a row"


def find_wedge(scene: Scene, gaps: dict[str, Nearest | None] | None = None) -> Wedge | None:
    """The deepest wedge at the initial pose, None where there is none; `gaps`: `facing_gap` of each pair by its name,
    where they are known."""
    if gaps is None:
        gaps = {contact.name: facing_gap(contact) for contact in scene.contacts}
    nearest = {name: near for name, near in gaps.items() if near is not None}
    deepest = -min((near[0] for near in nearest.values()), default=0.0)
    if deepest <= 0.0:
        return None
    pairs = [contact for contact in scene.contacts if contact.name in nearest]
    length = scene_length(scene)
    samples = [gap_samples(contact, nearest[contact.name]).below(NEARER * deepest) for contact in pairs]
    gradients = np.vstack([
        _gradients(contact, sample, len(scene.bodies), length) for contact, sample in zip(pairs, samples, strict=True)
    ])  # fmt: skip
    held = held_motions(scene)
    size = gradients.shape[1]
    answer = linprog(
        np.append(np.zeros(size), -1.0),
        A_ub=np.hstack([-gradients, np.ones((len(gradients), 1))]),
        b_ub=np.concatenate([sample.gap for sample in samples]) / deepest,
        A_eq=np.hstack([held, np.zeros((len(held), 1))]),
        b_eq=np.zeros(len(held)),
        bounds=[(-MOVED, MOVED)] * size + [(None, None)],
    )
    if not answer.success or answer.x[-1] > -SHALLOW:
        return None
    pulls = np.abs(answer.ineqlin.marginals)
    pushed = np.split(pulls > TAKES_PART * pulls.sum(), np.cumsum([len(sample.gap) for sample in samples])[:-1])
    found = [(c, sample.normal[at]) for c, sample, at in zip(pairs, samples, pushed, strict=True) if np.any(at)]
    normals = found[0][1]
    opposite = len(found) == 1 and bool(np.any(normals @ normals.T < 0.0))
    return Wedge(tuple(contact for contact, _ in found), -float(answer.x[-1]) * deepest, opposite)


def _gradients(contact: Contact, sample: GapSamples, bodies: int, length: float) -> np.ndarray:
    """Of the gaps, by translations and by turns, which are counted in `length` [m] (places, 6 bodies)."""
    lines = np.zeros((len(sample.gap), 6 * bodies))
    for sign, port in ((1.0, contact.a), (-1.0, contact.b)):
        if not port.on_ground:
            at = 6 * port.body.index
            arm = np.cross(sample.place - port.body.position, sample.normal) / length
            lines[:, at : at + 6] += sign * np.hstack([sample.normal, arm])
    return lines
