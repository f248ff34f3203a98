"""The study of runs to a wanted accuracy."""

from __future__ import annotations

import pytest

from studies.accuracy.machines import MACHINES
from studies.accuracy.measured import FINER, RATIOS, measure, others, page


def test_other_steps_meet_those_of_the_reference() -> None:
    for steps, finer in ((64, FINER), (206, FINER), (1450, FINER), (116, 4)):
        found = others(steps, finer)
        assert len(found) >= 3 and all(finer * steps % n == 0 for n in found)
        assert min(found) < steps < max(found) <= 2 * max(RATIOS) * steps


@pytest.mark.slow
def test_a_machine_is_measured() -> None:
    found = measure(MACHINES["pendulum"], progress=False)
    assert found.chosen.kept and found.best is not None
    assert found.best.seconds <= found.chosen.seconds
    assert "| a pendulum |" in page([found])
