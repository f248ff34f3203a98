r"""Shell elements of the MITC family with six degrees of freedom a node.

Degenerated solid (Ahmad, Irons, Zienkiewicz 1970). With the shape functions N_a, the unit normals d_a of the element at
its nodes and the distance z from the nodes' surface

    x = sum_a N_a (x_a + z d_a),        u = sum_a N_a (u_a + z theta_a x d_a),        o - t/2 <= z <= o + t/2.

Covariant strains in the coordinates (r, s, z), g_i = dx/dr_i: `e_rr = g_r.u_r`, `e_ss = g_s.u_s`,
`2 e_rs = g_r.u_s + g_s.u_r`, `2 e_rz = g_r.u_z + g_z.u_r`, `2 e_sz` alike; shear is taken at z = 0. In the local
Cartesian frame (e_1, e_2, n), `eps_kl = sum_ij e_ij (g^i.e_k)(g^j.e_l)`, and stress is plane: sigma_nn = 0, shear with
the factor 5/6. Two Gauss points through the thickness.

Locking is avoided by mixed interpolation of tensorial components: a strain is sampled at tying points, and
interpolated in a space B of fields b_j: with the functionals c_k at the points p_k, `A_kj = c_k b_j(p_k)`,

    e~(r, s) = sum_jk b_j(r, s) [A^-1]_jk c_k e(p_k).

| kind | tied | reference |
|---|---|---|
| tri3 | shear, MITC3+ | Lee, Lee, Bathe 2014, Comput. Struct. 138, 12 |
| quad4 | shear, MITC4 | Dvorkin, Bathe 1984, Eng. Comput. 1, 77 |
| tri6 | membrane, bending, shear, MITC6 | Lee, Bathe 2004, Comput. Struct. 82, 945 |
| quad8 | membrane, bending, shear, MITC9 | Bucalem, Bathe 1993, Int. J. Numer. Methods Eng. 36, 3729 |

A quad8 has a ninth node inside, at the centre of its surface, whose six freedoms are eliminated; mass is on the eight
nodes. In a quad8 that is no parallelogram the tied strain does other work than e against constant stress, and a patch
test would fail; so in each layer `e~ + mean(e - e~)` is used, in local axes. The rotation of a tri3 has an inner bubble
`27 r s (1 - r - s)` about two axes in its plane, eliminated too, without which thin plates lock. The membrane strain of
a quad4 is enhanced by four parameters, `(det J_0/det J) T_0 diag-modes(r, s)`, eliminated in the element (Simo, Rifai
1990, Int. J. Numer. Methods Eng. 29, 1595), so that it bends in its plane.

Drilling. The rotation about the normal is tied to that of the surface by the energy (Hughes, Brezzi 1989)

    gamma G t/2 int (theta.n - (u_2,1 - u_1,2)/2)^2 dA,        gamma = `DRILLING`.

It vanishes for rigid motion and in the patch test. gamma is small: the energy is to hold the rotation, not to stiffen.

Mass. Mass points at the quadrature points of both layers carry `rho det J` times their weight and move by u(r, s, z):
consistent translational and rotary inertia, with all inertia integrals of the floating frame. Rotation about the normal
has no mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.structure import Shell

Array = np.ndarray
DRILLING = 1e-3  # measured: 1e-6 to 1e-2 change the obstacle course by less than 1 % (docs/structures.md)
SMOOTH = 20.0  # degrees; larger angles between the elements of a node are folds
SHEAR_FACTOR = 5.0 / 6.0
CHUNK = 4000  # elements processed together: some 100 MB
_G2, _G3 = 1.0 / np.sqrt(3.0), np.sqrt(0.6)
_NEAR = 1e-4  # distance of tying points from the centre of a tri3 (Lee, Lee, Bathe 2014)
_LOW, _HIGH = 0.5 - 0.5 * _G2, 0.5 + 0.5 * _G2

# powers of r and s, and the nodes in the order of VTK
_MONOMIALS = {
    "tri3": ([(0, 0), (1, 0), (0, 1)], [(0, 0), (1, 0), (0, 1)]),
    "quad4": ([(0, 0), (1, 0), (0, 1), (1, 1)], [(-1, -1), (1, -1), (1, 1), (-1, 1)]),
    "tri6": (
        [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)],
        [(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)],
    ),
    "quad8": (
        [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 2)],
        [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0)],
    ),
    "quad9": (
        [(i, j) for i in range(3) for j in range(3)],
        [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0), (0, 0)],
    ),
}
RR, SS, RS, RZ, SZ = range(5)


def _powers(points: Array, powers: list[tuple[int, int]], dr: int = 0, ds: int = 0) -> Array:
    """Monomials (q, m), or their derivatives, at `points` (q, 2)."""
    r, s = np.atleast_2d(np.asarray(points, dtype=float)).T
    columns = []
    for i, j in powers:
        a = np.ones_like(r) * (1.0 if dr == 0 else float(i)) * (1.0 if ds == 0 else float(j))
        columns.append(a * r ** max(i - dr, 0) * s ** max(j - ds, 0))
    return np.stack(columns, axis=1)


def shape(kind: str, points: Any) -> tuple[Array, Array]:
    """Shape functions N (q, k) and their derivatives along r and s (q, 2, k)."""
    powers, nodes = _MONOMIALS[kind]
    inverse = np.linalg.inv(_powers(np.array(nodes), powers))
    at = np.array(points, dtype=float)
    return _powers(at, powers) @ inverse, np.stack(
        [_powers(at, powers, 1) @ inverse, _powers(at, powers, 0, 1) @ inverse], 1
    )


def _product(points: Any, weights: Any) -> tuple[Array, Array]:
    r, s = np.meshgrid(points, points, indexing="ij")
    return np.stack([r.ravel(), s.ravel()], 1), np.outer(weights, weights).ravel()


@cache
def rule(kind: str) -> tuple[Array, Array]:
    """Quadrature points (q, 2) and weights of an element."""
    if kind == "quad4":
        return _product([-_G2, _G2], [1.0, 1.0])
    if kind == "quad8":
        return _product([-_G3, 0.0, _G3], [5 / 9, 8 / 9, 5 / 9])
    a, b = 0.445948490915965, 0.091576213509771  # six points of degree 4 (Dunavant 1985)
    points = [[a, a], [1 - 2 * a, a], [a, 1 - 2 * a], [b, b], [1 - 2 * b, b], [b, 1 - 2 * b]]
    return np.array(points), 0.5 * np.repeat([0.223381589678011, 0.109951743655322], 3)


@dataclass(frozen=True, eq=False)
class Tying:
    """Fields b_j, lists of (component, powers, factor); functionals c_k, (point, {component: weight}); `combined`
    (J, K): coefficients of the fields from the functionals, None where these determine them."""

    fields: list[list[tuple[int, tuple[int, int], float]]]
    functionals: list[tuple[tuple[float, float], dict[int, float]]]
    combined: Array | None = None

    @property
    def points(self) -> Array:
        return np.array([point for point, _ in self.functionals])

    @property
    def weights(self) -> Array:
        """c (K, 5)."""
        c = np.zeros((len(self.functionals), 5))
        for k, (_, weights) in enumerate(self.functionals):
            for component, weight in weights.items():
                c[k, component] = weight
        return c

    def values(self, points: Array) -> Array:
        """b_j at points, (q, 5, J)."""
        b = np.zeros((len(points), 5, len(self.fields)))
        for j, terms in enumerate(self.fields):
            for component, powers, sign in terms:
                b[:, component, j] += sign * _powers(points, [powers])[:, 0]
        return b

    def interpolation(self, points: Array) -> Array:
        """(q, 5, K): strains at `points` from the values of the functionals."""
        if self.combined is not None:
            return self.values(points) @ self.combined
        A = np.einsum("kc,kcj->kj", self.weights, self.values(self.points))
        return self.values(points) @ np.linalg.inv(A)


def _fields(component: int, powers: list[tuple[int, int]]) -> list[list[tuple[int, tuple[int, int], float]]]:
    return [[(component, p, 1.0)] for p in powers]


@cache
def tyings(kind: str) -> dict[str, Tying]:
    """Schemes of "shear" and, for quadratic kinds, "plane" strains."""
    linear = [(0, 0), (1, 0), (0, 1)]
    low, high = _LOW, _HIGH
    if kind == "tri3":
        third, d = 1.0 / 3.0, _NEAR
        turning = [(RZ, (0, 1), 3.0), (RZ, (0, 0), -1.0), (SZ, (0, 0), 1.0), (SZ, (1, 0), -3.0)]
        A, B, C = (third / 2, 2 * third), (2 * third, third / 2), (third / 2, third / 2)
        D, E, F = (third + d, third - 2 * d), (third - 2 * d, third + d), (third + d, third + d)
        at = [(B, {RZ: 1.0, SZ: -0.5}), (A, {SZ: 1.0, RZ: -0.5}), (C, {RZ: 1.0, SZ: 1.0})]
        at += [(F, {RZ: 1.0, SZ: -1.0}), (D, {RZ: -1.0}), (E, {SZ: 1.0})]
        combined = third * np.array([[2, 0, 1, 0, 0, 0], [0, 2, 1, 0, 0, 0], [0, 0, 0, 1, 1, 1]], dtype=float)
        return {"shear": Tying([*_fields(RZ, linear[:1]), *_fields(SZ, linear[:1]), turning], at, combined)}
    if kind == "quad4":
        fields = [*_fields(RZ, [(0, 0), (0, 1)]), *_fields(SZ, [(0, 0), (1, 0)])]
        sides = [((0.0, e), {RZ: 1.0}) for e in (-1.0, 1.0)] + [((e, 0.0), {SZ: 1.0}) for e in (-1.0, 1.0)]
        return {"shear": Tying(fields, sides)}
    if kind == "tri6":
        fields = [f for c in (RR, SS, RS) for f in _fields(c, linear)]
        at = [((low, 0.0), {RR: 1.0}), ((high, 0.0), {RR: 1.0}), ((low, _G2), {RR: 1.0})]
        at += [((0.0, low), {SS: 1.0}), ((0.0, high), {SS: 1.0}), ((_G2, low), {SS: 1.0})]
        along = {RR: 0.5, SS: 0.5, RS: -0.5}
        at += [((high, low), along), ((low, high), along), ((low, low), along)]
        shear = [f for c in (RZ, SZ) for f in _fields(c, linear)]
        shear += [[(RZ, (1, 1), 1.0), (SZ, (2, 0), -1.0)], [(RZ, (0, 2), 1.0), (SZ, (1, 1), -1.0)]]
        edges = [((e, 0.0), {RZ: 1.0}) for e in (low, high)] + [((0.0, e), {SZ: 1.0}) for e in (low, high)]
        edges += [((high, low), {SZ: 1.0, RZ: -1.0}), ((low, high), {SZ: 1.0, RZ: -1.0})]
        edges += [((1 / 3, 1 / 3), {RZ: 1.0}), ((1 / 3, 1 / 3), {SZ: 1.0})]
        return {"plane": Tying(fields, at), "shear": Tying(shear, edges)}
    along_r, along_s = [(i, j) for i in (0, 1) for j in range(3)], [(j, i) for i in (0, 1) for j in range(3)]
    two, three = (-_G2, _G2), (-_G3, 0.0, _G3)
    on_r, on_s = [(a, b) for a in two for b in three], [(b, a) for a in two for b in three]
    both = [(i, j) for i in (0, 1) for j in (0, 1)]
    plane = Tying(
        [*_fields(RR, along_r), *_fields(SS, along_s), *_fields(RS, both)],
        [
            *((p, {RR: 1.0}) for p in on_r),
            *((p, {SS: 1.0}) for p in on_s),
            *(((a, b), {RS: 1.0}) for a in two for b in two),
        ],
    )
    shear = Tying(
        [*_fields(RZ, along_r), *_fields(SZ, along_s)],
        [*((p, {RZ: 1.0}) for p in on_r), *((p, {SZ: 1.0}) for p in on_s)],
    )
    return {"plane": plane, "shear": shear}


def skew(d: Array) -> Array:
    """(..., 3, 3): d x of vectors (..., 3)."""
    out = np.zeros((*d.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[..., j, i], out[..., i, j] = d[..., k], -d[..., k]
    return out


def normals(kind: str, x: Array, points: Any) -> Array:
    """Normals (e, q, 3), not normalised, of elements with nodes x (e, k, 3) at reference `points`."""
    a = np.einsum("qda,eai->eqdi", shape(kind, points)[1], x)
    return np.cross(a[:, :, 0], a[:, :, 1])


def directors(points: Array, shells: Sequence[Shell]) -> list[Array]:
    """Unit normals (m, k, 3) at the nodes of each shell: the mean over the elements of a node where all of these lie
    within `SMOOTH` of it, else those of the element."""
    own = []
    for shell in shells:
        n = normals(shell.kind, points[shell.nodes], _MONOMIALS[shell.kind][1])
        own.append(n / np.maximum(np.linalg.norm(n, axis=2), np.finfo(float).tiny)[:, :, None])
    total, least = np.zeros_like(points), np.ones(len(points))
    for shell, n in zip(shells, own, strict=True):
        np.add.at(total, shell.nodes, n)
    total /= np.maximum(np.linalg.norm(total, axis=1), np.finfo(float).tiny)[:, None]
    for shell, n in zip(shells, own, strict=True):
        np.minimum.at(least, shell.nodes, np.einsum("mki,mki->mk", n, total[shell.nodes]))
    smooth = least > np.cos(np.radians(SMOOTH))
    return [np.where(smooth[s.nodes][:, :, None], total[s.nodes], n) for s, n in zip(shells, own, strict=True)]


class ShellElements:
    """Elements of one kind with node positions `x` (e, k, 3) [m] and unit normals `directors` (e, k, 3) there, all of
    the thickness and material of `shell`."""

    def __init__(self, x: Array, shell: Shell, directors: Array) -> None:
        self.kind, self.shell = shell.kind, shell
        self.basis = "quad9" if self.kind == "quad8" else self.kind
        self.nodes = x
        self.k = x.shape[1]
        corners = np.array(_MONOMIALS[self.basis][1], dtype=float)
        N, _ = shape(self.kind, corners)
        normal = normals(self.kind, x, corners)
        length = np.linalg.norm(normal, axis=2)
        size = np.linalg.norm(x - x.mean(axis=1, keepdims=True), axis=2).max(axis=1)
        bad = np.flatnonzero(~np.all(length > 1e-8 * size[:, None] ** 2, axis=1))
        inner = np.einsum("eqi,ei->eq", normal, normal.mean(axis=1))
        bad = np.union1d(bad, np.flatnonzero(np.any(inner <= 0.0, axis=1)))
        if len(bad):
            raise InputError(
                f"shell {shell.name!r}: {len(bad)} elements are degenerate, concave or folded, the first at "
                f"{x[bad[0]].mean(axis=0).tolist()} m; repair the mesh"
            )
        self.x = np.einsum("qa,eai->eqi", N, x)  # with the inner node of a quad9
        self.d = np.concatenate([directors, (normal / length[:, :, None])[:, self.k :]], axis=1)
        self.W = -skew(self.d)  # theta x d = W theta
        # plane stress
        E, nu = shell.material.youngs_modulus, shell.material.poisson_ratio
        self.G = 0.5 * E / (1.0 + nu)
        C = np.zeros((5, 5))
        C[:2, :2] = E / (1.0 - nu * nu) * np.array([[1.0, nu], [nu, 1.0]])
        C[2, 2] = self.G
        C[3, 3] = C[4, 4] = SHEAR_FACTOR * self.G
        self.C = C
        side = x[:, 1] - x[:, 0]
        self.side = side / np.linalg.norm(side, axis=1)[:, None]
        half = 0.5 * shell.thickness
        self.layers = [(shell.offset + half * g, half) for g in (-_G2, _G2)]

    def covectors(self, kind: str, points: Any, z: float) -> Array:
        """g (e, q, 3, 3): rows g_r, g_s, g_z."""
        N, dN = shape(kind, points)
        k = N.shape[1]
        place = self.x[:, :k] + z * self.d[:, :k]
        tangents = np.einsum("qda,eai->eqdi", dN, place)
        return np.concatenate([tangents, np.einsum("qa,eai->eqi", N, self.d[:, :k])[:, :, None]], axis=2)

    def covariant(self, points: Any, z: float) -> Array:
        """Covariant strains (e, q, 5, 6 k) per nodal freedom, without tying."""
        N, dN = shape(self.basis, points)
        e, k = self.x.shape[:2]
        g = self.covectors(self.basis, points, z)
        B = np.zeros((e, len(N), 5, k, 6))
        turn = np.einsum("eqci,eaij->eqcaj", g, self.W, optimize=True)  # g_c . (theta x d_a)
        dr, ds = dN[:, 0], dN[:, 1]
        for row, i, j, D_i, D_j in ((RR, 0, 0, dr, None), (SS, 1, 1, ds, None), (RS, 0, 1, ds, dr)):
            B[:, :, row, :, :3] += np.einsum("eqi,qa->eqai", g[:, :, i], D_i)
            B[:, :, row, :, 3:] += z * turn[:, :, i] * D_i[None, :, :, None]
            if D_j is not None:
                B[:, :, row, :, :3] += np.einsum("eqi,qa->eqai", g[:, :, j], D_j)
                B[:, :, row, :, 3:] += z * turn[:, :, j] * D_j[None, :, :, None]
        for row, i, D in ((RZ, 0, dr), (SZ, 1, ds)):
            B[:, :, row, :, :3] += np.einsum("eqi,qa->eqai", g[:, :, 2], D)
            B[:, :, row, :, 3:] += turn[:, :, i] * N[None, :, :, None]
        B = B.reshape(e, len(N), 5, 6 * k)
        return B if self.kind != "tri3" else np.concatenate([B, self._bubble(points, g, z)], axis=3)

    def _bubble(self, points: Any, g: Array, z: float) -> Array:
        """Covariant strains (e, q, 5, 2) of the bubble rotations of a tri3 about its first two local axes."""
        r, s = np.array(points, dtype=float).T
        f, f_r, f_s = 27 * r * s * (1 - r - s), 27 * s * (1 - 2 * r - s), 27 * r * (1 - r - 2 * s)
        n = self.d.mean(axis=1)
        across = np.stack([-np.cross(n, self.side), self.side], axis=1)  # theta x n
        p = np.einsum("eqci,eti->eqct", g[:, :, :2], across, optimize=True)
        rows = [
            z * f_r[:, None] * p[:, :, 0],
            z * f_s[:, None] * p[:, :, 1],
            z * (f_s[:, None] * p[:, :, 0] + f_r[:, None] * p[:, :, 1]),
            f[:, None] * p[:, :, 0],
            f[:, None] * p[:, :, 1],
        ]
        return np.stack(rows, axis=2)

    def strains(self, points: Array, z: float) -> Array:
        """Covariant strains with tying (e, q, 5, 6 k)."""
        schemes = tyings(self.kind)
        B = self.covariant(points, z)
        for name, scheme in schemes.items():
            rows = slice(0, 3) if name == "plane" else slice(3, 5)
            at = self.covariant(scheme.points, z if name == "plane" else 0.0)
            sampled = np.einsum("kc,ekcn->ekn", scheme.weights, at, optimize=True)
            B[:, :, rows] = np.einsum("qck,ekn->eqcn", scheme.interpolation(points)[:, rows], sampled, optimize=True)
        return B

    def frames(self, points: Array, z: float) -> tuple[Array, Array, Array]:
        """Local axes (e, q, 3, 3) in rows, strain transformation T (e, q, 5, 5), det J (e, q)."""
        g = self.covectors(self.basis, points, z)
        n = np.cross(g[:, :, 0], g[:, :, 1])
        n /= np.linalg.norm(n, axis=2)[:, :, None]
        e1 = self.side[:, None] - np.einsum("ei,eqi->eq", self.side, n)[:, :, None] * n
        e1 /= np.linalg.norm(e1, axis=2)[:, :, None]
        axes = np.stack([e1, np.cross(n, e1), n], axis=2)
        c = np.einsum("eqij,eqlj->eqil", np.linalg.inv(g).swapaxes(2, 3), axes)  # g^i . e_l
        T = np.zeros((*g.shape[:2], 5, 5))
        pairs = ((0, 0), (1, 1), (0, 1), (0, 2), (1, 2))
        for row, (k, m) in enumerate(pairs):
            twice = 1.0 if k == m else 2.0
            for column, (i, j) in enumerate(pairs):
                if i == j:
                    T[:, :, row, column] = twice * c[:, :, i, k] * c[:, :, i, m]
                else:
                    mixed = c[:, :, i, k] * c[:, :, j, m] + c[:, :, j, k] * c[:, :, i, m]
                    T[:, :, row, column] = 0.5 * twice * mixed
        return axes, T, np.linalg.det(g)

    def local_strains(self, points: Array, z: float) -> tuple[Array, Array, Array]:
        """Local axes, strains (e, q, 5, 6 k + inner) in them, det J."""
        axes, T, det = self.frames(points, z)
        B = T @ self.strains(points, z)
        if self.kind == "quad8":
            where, weights = rule(self.kind)
            _, T_mean, det_mean = self.frames(where, z)
            share = det_mean * weights
            share /= share.sum(axis=1)[:, None]
            off = T_mean @ (self.covariant(where, z) - self.strains(where, z))
            B[:, :, :3] += np.einsum("eq,eqcn->ecn", share, off[:, :, :3], optimize=True)[:, None]
        if self.kind == "quad4":
            middle = np.zeros((1, 2))
            _, T0, det0 = self.frames(middle, self.shell.offset)
            r, s = points.T
            zero = np.zeros_like(r)
            modes = np.stack([[r, zero, zero, zero], [zero, s, zero, zero], [zero, zero, r, s]]).transpose(2, 0, 1)
            enhanced = np.zeros((*B.shape[:3], 4))
            ratio = (det0 / det)[:, :, None, None]
            enhanced[:, :, :3] = ratio * np.einsum("ecd,qdm->eqcm", T0[:, 0, :3, :3], modes)
            B = np.concatenate([B, enhanced], axis=3)
        return axes, B, det

    def full_stiffness(self) -> Array:
        """K (e, 6 k + inner, 6 k + inner), inner freedoms last."""
        points, weights = rule(self.kind)
        K = 0.0
        for z, weight in self.layers:
            _, B, det = self.local_strains(points, z)
            dV = det * weights * weight
            e, q, _, n = B.shape
            CB = np.matmul(self.C, B) * dV[:, :, None, None]
            K = K + np.matmul(B.reshape(e, 5 * q, n).swapaxes(1, 2), CB.reshape(e, 5 * q, n))
        K = np.asarray(K)
        D, dA = self.drilling(points, weights)
        m = D.shape[2]
        K[:, :m, :m] += DRILLING * self.G * self.shell.thickness * np.einsum("eqm,eqn,eq->emn", D, D, dA, optimize=True)
        return K

    def drilling(self, points: Array, weights: Array) -> tuple[Array, Array]:
        """theta.n - (u_2,1 - u_1,2)/2 per nodal freedom (e, q, 6 k), and dA (e, q)."""
        N, dN = shape(self.basis, points)
        axes, _, _ = self.frames(points, 0.0)
        g = self.covectors(self.basis, points, 0.0)
        dual = np.linalg.inv(g).swapaxes(2, 3)
        slopes = np.einsum("eqdi,eqli,qda->eqla", dual[:, :, :2], axes[:, :, :2], dN, optimize=True)  # N_a,l
        D = np.zeros((*slopes.shape[:2], N.shape[1], 6))
        D[..., :3] = -0.5 * np.einsum("eqa,eqi->eqai", slopes[:, :, 0], axes[:, :, 1])
        D[..., :3] += 0.5 * np.einsum("eqa,eqi->eqai", slopes[:, :, 1], axes[:, :, 0])
        D[..., 3:] = np.einsum("qa,eqi->eqai", N, axes[:, :, 2])
        dA = np.linalg.norm(np.cross(g[:, :, 0], g[:, :, 1]), axis=2) * weights
        return D.reshape(*D.shape[:2], -1), dA

    def condensed(self) -> tuple[Array, Array]:
        """K (e, 6 k, 6 k) of the nodes, and the inner freedoms per nodal one (e, inner, 6 k)."""
        K = self.full_stiffness()
        m = 6 * self.k
        if K.shape[1] == m:
            return K, np.zeros((len(K), 0, m))
        inner = -np.linalg.solve(K[:, m:, m:], K[:, m:, :m])
        K = K[:, :m, :m] + np.matmul(K[:, :m, m:], inner)
        return 0.5 * (K + K.swapaxes(1, 2)), inner

    def mass_points(self) -> tuple[Array, Array, Array]:
        """Positions (e, p, 3) [m], masses (e, p) [kg], and motion (e, p, 3, 6 k) per nodal freedom."""
        points, weights = rule(self.kind)
        N, _ = shape(self.kind, points)
        k = self.k
        places, masses, motions = [], [], []
        for z, weight in self.layers:
            det = np.linalg.det(self.covectors(self.kind, points, z))
            masses.append(self.shell.material.density * det * weights * weight)
            places.append(np.einsum("qa,eai->eqi", N, self.x[:, :k] + z * self.d[:, :k]))
            U = np.zeros((len(self.x), len(N), 3, k, 6))
            U[..., :3] = np.einsum("qa,ij->qiaj", N, np.eye(3))
            U[..., 3:] = z * np.einsum("qa,eaij->eqiaj", N, self.W[:, :k])
            motions.append(U.reshape(len(self.x), len(N), 3, 6 * k))
        return np.concatenate(places, 1), np.concatenate(masses, 1), np.concatenate(motions, 1)

    def stress(self, z: float) -> tuple[Array, Array]:
        """At the centre of each element and the distance z: positions (e, 3), stress (e, 6, 6 k) [Pa] (xx, yy, zz, xy,
        yz, zx), user axes, per nodal freedom. Transverse shear is 0 on the faces, 3/2 of its mean in the middle."""
        centre = np.array([[0.0, 0.0]]) if self.kind.startswith("quad") else np.array([[1 / 3, 1 / 3]])
        axes, B, _ = self.local_strains(centre, z)
        _, inner = self.condensed()
        m = 6 * self.k
        B = B[:, 0, :, :m] + np.matmul(B[:, 0, :, m:], inner)
        s = np.matmul(self.C, B)
        inside = 2.0 * (z - self.shell.offset) / self.shell.thickness
        s[:, 3:] *= 1.5 * (1.0 - inside**2)
        local = np.zeros((len(s), 3, 3, m))
        for row, (i, j) in enumerate(((0, 0), (1, 1), (0, 1), (0, 2), (1, 2))):
            local[:, i, j] = local[:, j, i] = s[:, row]
        A = axes[:, 0]
        tensor = np.einsum("eia,eijm,ejb->eabm", A, local, A, optimize=True)
        six = np.stack([tensor[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))], axis=1)
        N, _ = shape(self.basis, centre)
        return np.einsum("a,eai->ei", N[0], self.x + z * self.d), six
