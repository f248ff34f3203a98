"""An independent full finite-element model: scikit-fem's own vector basis, dense saddle point for the free body."""

from __future__ import annotations

import numpy as np
import scipy.linalg as sla


def matrices(mesh, material):
    """K, M dense (3 n, 3 n) by scikit-fem on hex8 or tet4 meshes, node-interleaved in mesh numbering."""
    import skfem
    from skfem.helpers import ddot, dot, eye, sym_grad, trace

    ((kind, cells),) = mesh.cells.items()
    # scikit-fem's hexahedron: vertex i of its element lies at doflocs[i]; VTK corner with the same place
    element = {"hex8": skfem.ElementHex1, "tet4": skfem.ElementTetP1}[kind]()
    vtk = {
        "hex8": np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]),
        "tet4": np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]),
    }[kind]
    order = [int(np.flatnonzero((vtk == place).all(axis=1))[0]) for place in element.doflocs]
    maker = {"hex8": skfem.MeshHex, "tet4": skfem.MeshTet}[kind]
    grid = maker(mesh.points.T.copy(), cells[:, order].T.copy())
    vector = skfem.ElementVector(element)
    basis = skfem.Basis(grid, vector, intorder=3)  # 2 x 2 x 2 points in a hexahedron, for K and for M
    lam, mu = material.lame

    @skfem.BilinearForm
    def stiffness(u, v, _):
        e = sym_grad(u)
        return ddot(lam * eye(trace(e), 3) + 2.0 * mu * e, sym_grad(v))

    @skfem.BilinearForm
    def mass(u, v, _):
        return material.density * dot(u, v)

    order = np.asarray(basis.nodal_dofs).T.ravel()
    return tuple(form.toarray()[np.ix_(order, order)] for form in (stiffness.assemble(basis), mass.assemble(basis)))


def free_response(K, M, R, f):
    """Static response (n, m) to loads f under inertia relief, M-orthogonal to R, by a dense saddle point.

    [K  M R; R^T M  0] [u; lam] = [f; 0]: the multipliers are the rigid accelerations.
    """
    MR = M @ R
    r = R.shape[1]
    scale = np.abs(K).max() / np.abs(MR).max()
    system = np.block([[K, MR * scale], [MR.T * scale, np.zeros((r, r))]])
    return sla.solve(system, np.concatenate([f, np.zeros((r, f.shape[1]))]))[: len(K)]
