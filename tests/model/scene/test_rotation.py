"""Quaternions against SciPy's rotations."""

from typing import Any

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


TURNED = Rotation.from_euler("xyz", (0.1, -0.4, 2.0))
FORMS = {
    "quaternion": TURNED.as_quat(),
    "matrix": TURNED.as_matrix(),
    "scipy": TURNED,
    "axis and angle": {"axis": 3.0 * TURNED.as_rotvec(), "angle": TURNED.magnitude()},
    "about fixed axes": {"xyz": (0.1, -0.4, 2.0)},
    "about turning axes": {"ZYX": (2.0, -0.4, 0.1)},
    "two of them": {"zx": TURNED.as_euler("zxz")[:2]},
}


@pytest.mark.parametrize("form", FORMS)
def test_a_pose_in_any_form(form: str) -> None:
    """Every form is scipy's rotation of the same numbers; q and -q are one."""
    value = FORMS[form]
    wanted = Rotation.from_euler("zx", value["zx"]) if form == "two of them" else TURNED
    q = rot.orientation(value, "body: rotation")
    assert abs(q @ wanted.as_quat()) == pytest.approx(1.0, abs=1e-14)  # round-off
    assert q @ q == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize(
    ("value", "says"),
    [
        ((0.1, 0.2, 0.3), r"got shape \(3,\)"),
        ("x", "must be a quaternion"),
        ([[1, 2], [3]], "must be a quaternion"),
        ({"axis": (0, 0, 1)}, "must be a quaternion"),
        ({"xYz": (1, 2, 3)}, "Euler angles"),
        ({"xyz": (1, 2)}, "xyz must have shape"),
        ({"axis": (0, 0, 0), "angle": 1.0}, "axis has zero length"),
        (np.diag([1.0, 1.0, -1.0]), "is a reflection"),
        (2.0 * np.eye(3), "is no rotation"),
        (Rotation.from_euler("x", [[0.1], [0.2]]), "must have shape"),
        ((0.0, 0.0, 1.0, 1.0), "unit quaternion"),
    ],
)
def test_what_is_no_pose(value: Any, says: str) -> None:
    with pytest.raises(InputError, match=f"body: rotation.*{says}"):
        rot.orientation(value, "body: rotation")


def test_doubtful_poses_are_said(caplog: pytest.LogCaptureFixture) -> None:
    for value, words in (
        ((1.0, 0.0, 0.0, 0.0), "180 degrees about x"),
        ({"axis": (0, 0, 1), "angle": 90.0}, "np.radians(90)"),
        ({"xyz": (0, 0, 45)}, "np.radians(45)"),
    ):
        caplog.clear()
        rot.orientation(value, "body: rotation")
        assert [r.levelname for r in caplog.records] == ["WARNING"] and words in caplog.text
    caplog.clear()
    rot.orientation({"axis": (1, 0, 0), "angle": np.pi}, "body: rotation")
    assert not caplog.records
