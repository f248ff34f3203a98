"""Runs of many scenes side by side in the worlds of one engine.

Each run is a thread with the code of a run by itself, `online.run.run` or `online.load_steps.run_static`, and an engine
of its own, its place in the one they share (`warpffrf.online.worlds.engines`): start, watching, notes and history are
those of the scene alone. One thread works at a time, but for the graph, which steps all worlds at once.
"""

from __future__ import annotations

import contextvars
import threading
from collections.abc import Callable, Sequence

from warpffrf.model.errors import InputError
from warpffrf.model.messages.progress import Progress
from warpffrf.online.engine import EngineOf
from warpffrf.online.history.history import History
from warpffrf.online.worlds.engines import Company
from warpffrf.online.worlds.meeting import Ended

LOOK = 0.2  # s between two looks at how far the runs have come

Run = Callable[[EngineOf], History]


def side_by_side(runs: Sequence[Run], steps: int, *, progress: bool) -> list[History]:
    """The histories of `runs`, which are given what makes their engines, in their order; steps: of each, for the bar.

    A run that fails leaves its History, and the others go on. An error ends all: `InputError` with the number of the
    scene in front where it is one scene's. KeyboardInterrupt comes to every run as to one alone; it is raised where a
    run had not begun its steps.
    """
    company = Company(len(runs), progress)
    found: list[History | None] = [None] * len(runs)
    errors: dict[int, BaseException] = {}

    def work(i: int) -> None:
        try:
            found[i] = runs[i](company.engine_of(i))
        except Ended:
            pass
        except BaseException as error:
            errors[i] = error
            company.meeting.end(KeyboardInterrupt if isinstance(error, KeyboardInterrupt) else Ended)
        finally:
            company.meeting.leave(i)

    threads = [
        threading.Thread(target=contextvars.copy_context().run, args=(work, i), name=f"world {i}", daemon=True)
        for i in range(len(runs))
    ]
    bar = Progress("simulate", steps, enabled=progress)
    try:
        for thread in threads:
            thread.start()
        _wait(threads, company, bar)
    except KeyboardInterrupt as interruption:
        company.meeting.end(KeyboardInterrupt)
        for i, thread in enumerate(threads):
            if thread.ident is None:  # it never began, and the others wait for it
                errors[i] = interruption
                company.meeting.leave(i)
        _wait(threads, company, bar)
    bar.close()
    if errors:
        i = min(errors)
        error = errors[i]
        if isinstance(error, InputError) and error is not company.meeting.error:
            raise InputError(f"scene {i}: {error}") from error
        raise error
    return [history for history in found if history is not None]


def _wait(threads: Sequence[threading.Thread], company: Company, bar: Progress) -> None:
    for thread in threads:
        while thread.is_alive():
            thread.join(LOOK)
            bar.update(company.steps)
