"""Exponential map and inverse tangent of `rotation` against SciPy, on both sides of the switch to the series."""

# Warp kernels confuse it
# pyright: reportInvalidTypeForm=false, reportAssignmentType=false, reportGeneralTypeIssues=false
from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from scipy.linalg import expm

from warpffrf_kernels.core.rotation import exponential, matrix, tangent_inverse
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def rotate(psi: wp.array(dtype=vec3), R: wp.array(dtype=mat33), T_inverse: wp.array(dtype=mat33)):
    i = wp.tid()
    R[i] = matrix(exponential(psi[i]))
    T_inverse[i] = tangent_inverse(psi[i])


def hat(a: np.ndarray) -> np.ndarray:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.999e-4, 1.001e-4, 0.00999, 0.01001, 0.3, 2.0, 3.1])
def test_against_the_matrix_exponential(angle: float) -> None:
    axis = np.array([0.48, -0.6, 0.64])
    psi = angle * axis
    R, T_inverse = (wp.zeros(1, dtype=mat33, device="cpu") for _ in range(2))
    wp.launch(rotate, dim=1, inputs=[wp.array([psi], dtype=vec3, device="cpu")], outputs=[R, T_inverse], device="cpu")
    assert np.allclose(R.numpy()[0], expm(hat(psi)), atol=1e-14)
    # T = int_0^1 exp(-s psi^) ds
    s, w = np.polynomial.legendre.leggauss(20)
    T = sum(0.5 * b * expm(-0.5 * (a + 1.0) * hat(psi)) for a, b in zip(s, w, strict=True))
    assert np.allclose(T_inverse.numpy()[0] @ T, np.eye(3), atol=3e-13)
