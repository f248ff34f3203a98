"""Fixtures: the synthetic run of `synthetic_run.py`."""

from __future__ import annotations

import pytest
from synthetic_run import make_history, roller

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.history.history import History
from warpffrf.output.result import Result


@pytest.fixture(scope="session")
def body() -> ReducedBody:
    return roller()


@pytest.fixture
def history(body: ReducedBody) -> History:
    return make_history(body)


@pytest.fixture
def result(history: History) -> Result:
    return Result(history)
