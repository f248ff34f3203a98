"""Mistakes are answered with the name of the thing and the cure (`workshop.py`)."""

from __future__ import annotations

import logging
from pathlib import Path

import mistakes_of_bodies
import mistakes_of_scenes
import pytest
from mistakes_of_scenes import ARGUED
from workshop import Mistake, Workshop, reduced

import warpffrf as wf

MISTAKES = (*mistakes_of_bodies.MISTAKES, *mistakes_of_scenes.MISTAKES)
ANSWERED = 92  # of 95 at least


def answer(mistake: Mistake, folder: Path, log: pytest.LogCaptureFixture) -> str:
    """What the user reads: the error, else the warnings."""
    workshop = Workshop(folder)
    log.clear()
    try:
        with log.at_level(logging.WARNING, logger="warpffrf"):
            mistake.call(workshop)
    except (wf.InputError, TypeError) as error:
        return str(error)
    return "\n".join(record.getMessage() for record in log.records if record.name.startswith("warpffrf"))


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.name)
def test_a_mistake_is_answered(mistake: Mistake, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    said = answer(mistake, tmp_path, caplog)
    missing = [words for words in mistake.words if words not in said]
    assert not missing, f"{missing} not in: {said or 'nothing was said'}"


def test_there_are_enough() -> None:
    assert len({mistake.name for mistake in MISTAKES}) == len(MISTAKES) >= ANSWERED
    assert len(ARGUED) <= 3 and all(ARGUED.values())


def test_what_is_right_is_not_doubted(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    workshop = Workshop(tmp_path)
    workshop.scene.add_body(reduced(), name="x", rotation={"axis": (1, 0, 0), "angle": 3.0})
    wf.forces.PrismaticFriction(workshop.guide, friction=0.3, bearing_length=0.1)
    assert not [record for record in caplog.records if record.levelno >= logging.WARNING]
