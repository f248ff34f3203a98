r"""Global modes: vibration modes and interface attachment modes, jointly M- and K-orthonormal.

An *attachment mode* is the inertia-relief response to a unit force or moment on an interface, `a = P^H K^+ P F_I`. With
`a` in the span of `Phi_g` the residual local response does not move the interface: for a load f its interface
coordinates are `F_I^H (G - Phi_g (Phi_g^H K Phi_g)^-1 Phi_g^H) f = a^H f - a^H f = 0`.

The union of the attachment modes A and many vibration modes V is nearly dependent (condition 7e15 was met). It is
orthonormalised in the *energy* inner product, the attachment modes first, so that they stay in the span to round-off:

1. A is scaled to unit energy; eigenvectors of `A^H K A` below `dependent^2` are dropped, the others scaled to unit
   energy;
2. V, scaled to unit energy, is freed from A, `V := V - A A^H K V`, twice, and treated alike: what is dropped is a
   combination of vibration modes that A holds already. Both go through this a second time, in which nothing may shrink;
3. now `Q = [A V]` has `Q^H K Q = 1`; with `Q^H M Q = Y mu Y^H` the modes are `Phi = Q Y mu^-1/2`: M-orthonormal,
   K-orthogonal, and `omega^2 = 1/mu` is the Rayleigh-Ritz frequency.
"""

from __future__ import annotations

import numpy as np

from warpffrf.offline.elastic import Array, ElasticModel

# Energy norm of a unit-energy direction outside the others below which it is dropped: round-off of the Gram matrix,
# 1e-16 in its eigenvalues, is 1e-8 in a norm.
DEPENDENT = 3e-8
# Energy of a unit-energy direction that must be left when it is orthogonalised again: one that was round-off shrinks.
MOSTLY_THERE = 0.5


def attachment_modes(model: ElasticModel, F: Array) -> Array:
    """Inertia-relief responses (n, a) to interface loads F (n, a)."""
    return model.flexibility(F)


def global_basis(model: ElasticModel, V: Array, A: Array, *, dependent: float = DEPENDENT) -> tuple[Array, Array, int]:
    """`omega` (m,) [rad/s] ascending, `Phi` (n, m), and the number of dropped directions.

    V (n, v): vibration modes, or the columns of any other basis; A (n, a): attachment modes; all M-orthogonal to rigid
    motion. A unit-energy direction whose part outside the others has an energy norm below `dependent` is dropped.
    """
    offered = V.shape[1] + A.shape[1]
    A = _independent(model, _scaled(model, A), None, dependent)
    V = _freed(model, _independent(model, _scaled(model, V), A, dependent), A)
    Q = np.concatenate([A, V], axis=1)
    if not Q.shape[1]:
        return np.zeros(0), Q, offered
    mu, Y = np.linalg.eigh(_hermitian(Q.conj().T @ (model.M @ Q)))
    mu, Y = mu[::-1], Y[:, ::-1]
    return 1.0 / np.sqrt(mu), Q @ (Y / np.sqrt(mu)), offered - Q.shape[1]


def _scaled(model: ElasticModel, U: Array) -> Array:
    """Columns scaled to unit energy; those without energy, as of a load that strains nothing, become zero."""
    energy = np.real(np.einsum("na,na->a", U.conj(), model.K @ U))
    scale = np.zeros_like(energy)
    scale[energy > 0.0] = 1.0 / np.sqrt(energy[energy > 0.0])
    return U * scale


def _freed(model: ElasticModel, U: Array, A: Array | None) -> Array:
    """U without its K-projection on the K-orthonormal A, and without rigid motion: that has no energy, so that scaling
    to unit energy blows up what little of it round-off left."""
    for _ in range(2):  # twice is enough (Kahan, Parlett)
        U = model.without_rigid(U if A is None else U - A @ (A.conj().T @ (model.K @ U)))
    return U


def _independent(model: ElasticModel, U: Array, A: Array | None, dependent: float) -> Array:
    """K-orthonormal basis of the columns of U outside A, without directions of energy norm below `dependent`."""
    for least in (dependent**2, MOSTLY_THERE):  # the second pass repairs what small eigenvalues cost in orthogonality
        U = _freed(model, U, A)
        values, vectors = np.linalg.eigh(_hermitian(U.conj().T @ (model.K @ U)))
        keep = values > least
        U = U @ (vectors[:, keep] / np.sqrt(values[keep]))
    return U


def _hermitian(A: Array) -> Array:
    return 0.5 * (A + A.conj().T)


def missing_energy(model: ElasticModel, V: Array, A: Array, *, dependent: float = DEPENDENT) -> float:
    """Largest energy norm (0 to 1) of a unit-energy column of A outside the span of V: what V lacks of A."""
    if not A.shape[1]:
        return 0.0
    A, V = _scaled(model, A), _independent(model, _scaled(model, V), None, dependent)
    rest = _freed(model, A, V)
    return float(np.sqrt(max(np.max(np.real(np.einsum("na,na->a", rest.conj(), model.K @ rest))), 0.0)))
