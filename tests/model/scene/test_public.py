"""The public face: names, and what importing the package costs."""

import subprocess
import sys

import pytest

import warpffrf

HEAVY = ("rerun", "matplotlib", "trimesh", "meshio", "skfem", "warp", "xarray", "pyvista")


def loaded_after(code: str) -> set[str]:
    """Top-level modules loaded in a fresh interpreter after running `code`."""
    script = f"{code}\nimport sys\nprint(','.join(sorted({{m.split('.')[0] for m in sys.modules}})))"
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(result.stdout.strip().split(","))


def test_importing_the_package_loads_nothing_heavy() -> None:
    assert not loaded_after("import warpffrf") & set(HEAVY)


def test_describing_a_scene_loads_neither_viewer_nor_engine() -> None:
    code = (
        "import warpffrf as wf\n"
        "wf.Scene(); wf.Material(1, 0.3, 1); wf.joints.Revolute; wf.signals.Ramp; wf.forces.PointForce; wf.Contact\n"
        "mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=8, layers=1, axial=1)\n"
        "wf.surfaces.Cylinder().fitted(mesh.points[mesh.facets('rim').node_set])"
    )
    assert not loaded_after(code) & set(HEAVY)


def test_all_names_exist() -> None:
    assert sorted(warpffrf.__all__) == warpffrf.__all__ and len(warpffrf.__all__) <= 52  # Simulation, control
    assert set(warpffrf.__all__) <= set(dir(warpffrf))
    for name in warpffrf.__all__:
        assert getattr(warpffrf, name) is not None
    with pytest.raises(AttributeError, match="'simulat'"):
        _ = warpffrf.simulat  # pyright: ignore[reportAttributeAccessIssue]
