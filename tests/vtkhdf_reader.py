"""VTKHDF files read by VTK's own reader, through pyvista."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest


def read_vtkhdf(path: Path, step: int) -> tuple[Any, list[float]]:
    """The blocks of a file at a step, and the times of all steps. Skips the test without pyvista."""
    pyvista = pytest.importorskip("pyvista")
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    reader.SetStep(step)
    reader.Update()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    return pyvista.wrap(reader.GetOutput()), list(times or ())  # one step has no time
