"""Histories of lumped contacts, from the saved rows of their places."""

from __future__ import annotations

import numpy as np

from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.compile.scene import CompiledScene
from warpffrf.online.history.history import BodyHistory, LumpedHistory


def lumped_histories(
    compiled: CompiledScene, rows: SavedRows, bodies: dict[str, BodyHistory]
) -> dict[str, LumpedHistory]:
    """By name."""
    owner = compiled.elements.lumped.contact.numpy()[: compiled.elements.lumped.places]
    resisting = owner[compiled.elements.moments.place.numpy()[: compiled.elements.moments.count]]
    found = {}
    for i, contact in enumerate(compiled.scene.lumped_contacts):
        body = contact.a.body.name
        origin = bodies[body].position if body in bodies else np.zeros(3)  # of the ground the world's origin
        moment = rows["saved_lumped_moment"][:, np.flatnonzero(resisting == i)].sum(axis=1)
        found[contact.name] = _history(rows["saved_lumped"][:, np.flatnonzero(owner == i)], moment, origin)
    return found


def _history(saved: np.ndarray, moment: np.ndarray, origin: np.ndarray) -> LumpedHistory:
    """Of places (T, places, numbers) and the moment (T, 3) of all of them, torque about `origin`."""
    x, force, friction, slip = (saved[:, :, 3 * n : 3 * n + 3] for n in range(4))
    approach, normal = saved[:, :, 12], saved[:, :, 13]
    pressed = np.sum(normal, axis=1)
    nearest = np.eye(saved.shape[1])[np.argmax(approach, axis=1)]
    weight = np.where(pressed[:, None] > 0.0, normal / np.maximum(pressed[:, None], np.finfo(float).tiny), nearest)
    return LumpedHistory(
        force=force.sum(axis=1),
        torque=np.cross(x - np.asarray(origin)[..., None, :], force).sum(axis=1) + moment, moment=moment,
        place=np.einsum("tp,tpi->ti", weight, x), approach=approach.max(axis=1), normal_force=pressed,
        friction_force=friction.sum(axis=1), slip_velocity=np.einsum("tp,tpi->ti", weight, slip),
        lamina_force=normal.copy(),
    )  # fmt: skip
