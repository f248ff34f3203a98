"""Quaternions against SciPy's rotations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError

vectors = st.tuples(*[st.floats(-4.0, 4.0)] * 3)


@given(vectors)
def test_matrix_and_quaternion_agree_with_scipy(vector) -> None:
    reference = Rotation.from_rotvec(vector)
    A = rot.rotation_vector_matrix(np.array(vector))
    np.testing.assert_allclose(A, reference.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(rot.matrix(reference.as_quat()), reference.as_matrix(), atol=1e-14)
    q = rot.quaternion(A)
    assert q[3] >= 0.0
    np.testing.assert_allclose(rot.matrix(q), A, atol=1e-14)


def test_half_turns() -> None:
    for axis in np.eye(3):
        A = 2.0 * np.outer(axis, axis) - np.eye(3)
        np.testing.assert_allclose(rot.matrix(rot.quaternion(A)), A, atol=1e-15)


def test_length_is_checked() -> None:
    with pytest.raises(InputError, match="pose must be a unit quaternion"):
        rot.unit_quaternion((1.0, 0.0, 0.0, 1.0), "pose")
    np.testing.assert_allclose(np.linalg.norm(rot.unit_quaternion((0, 0, 0.707107, 0.707107), "pose")), 1.0, rtol=1e-15)
