"""Flexible bodies made of mass points: small, exact, with every term of their inertia, and no finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.data import DisplaySurface, Interface
from warpffrf.model.reduced.inertia import GeometricStiffness, InertiaTerms


def mass_point_body(
    modes: int, *, seed: int = 0, points: int = 9, lowest: float = 40.0, stiffening: bool = False, squares: int = 0
) -> ReducedBody:
    """`points` masses in a box of 0.4 m with `modes` random displacement fields, free of rigid motion (Tisserand) and
    M-orthonormal; frequencies from `lowest` [Hz] up; interfaces "left" and "right" move with random small parts.
    `squares` of membrane energy, that doubles the stiffness of the modes where they move by a millimetre or two."""
    rng = np.random.default_rng(seed)
    m = rng.uniform(0.1, 0.3, points)
    X = rng.uniform(-0.2, 0.2, (points, 3))
    X -= (m @ X) / m.sum()
    rigid = np.zeros((6, points, 3))
    for a in range(3):
        rigid[a, :, a] = 1.0
        rigid[3 + a] = np.cross(np.eye(3)[a], X)
    root = np.sqrt(np.repeat(m, 3))
    R, _ = np.linalg.qr((rigid.reshape(6, -1) * root).T)
    fields = rng.normal(size=(3 * points, modes))
    for _ in range(2):
        fields -= R @ (R.T @ fields)
    Q, _ = np.linalg.qr(fields)
    phi = (Q / root[:, None]).T.reshape(modes, points, 3)
    one = np.eye(3)
    dot = np.einsum("p,px,ipx->i", m, X, phi)
    outer = np.einsum("p,px,ipy->ixy", m, X, phi)
    first = 2.0 * dot[:, None, None] * one - outer - outer.transpose(0, 2, 1)
    pair = np.einsum("p,ipx,jpy->ijxy", m, phi, phi)
    second = np.einsum("ijxx->ij", pair)[:, :, None, None] * one - 0.5 * (pair + pair.transpose(0, 1, 3, 2))
    gyroscopic = np.einsum("p,ijpx->ijx", m, np.cross(phi[:, None], phi[None]))
    J0 = np.einsum("p,px,px->", m, X, X) * one - np.einsum("p,px,py->xy", m, X, X)
    interfaces, by_load = {}, {}
    for name, at in (("left", 0), ("right", 1)):
        shape = np.concatenate([phi[:, at], 2.0 * rng.normal(size=(modes, 3))], axis=1)
        interfaces[name] = Interface("rigid", X[at].copy(), shape)
        S = rng.normal(size=(6, modes, modes))
        by_load[name] = 0.5 * (S + S.transpose(0, 2, 1))
    centrifugal = rng.normal(size=(6, modes, modes))
    geometric = GeometricStiffness(0.5 * (centrifugal + centrifugal.transpose(0, 2, 1)), by_load)
    if squares:
        forms = 100.0 * (2.0 * np.pi * lowest) * rng.normal(size=(squares, modes, modes))
        geometric = replace(geometric, membrane=0.5 * (forms + forms.transpose(0, 2, 1)))
    terms = InertiaTerms(first, second, gyroscopic, geometric if stiffening else None)
    skin = DisplaySurface(X, np.zeros((0, 3), dtype=int), phi)
    frequencies = lowest * (1.0 + 0.4 * np.arange(modes))
    return ReducedBody(float(m.sum()), np.zeros(3), J0, frequencies, interfaces, {}, skin, inertia_terms=terms)
