"""Runs in several threads: the same bits as alone; forks in the middle of them; a turn that is left and taken."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
import warp as wp

import warpffrf as wf
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.history.history import History
from warpffrf.online.warp_lock import WARP_LOCK, WarpLock, replays_side_by_side

THREADS = 4


def pendulum() -> wf.Scene:
    scene = wf.Scene(gravity=(0, 0, -9.81))
    bob = scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="bob", position=(0.5, 0, 0))
    scene.add(wf.joints.Revolute(scene.ground, bob.at((-0.5, 0, 0)), axis=(0, 1, 0), name="hinge"))
    return scene


def pressed(body: ReducedBody) -> wf.Scene:
    """Two rollers, the upper one pressed on by a spring."""
    scene = wf.Scene(gravity=(0, 0, -9.81))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0, 0, 0.1))
    scene.close_gap(scene.add(wf.Contact(lower["rim"], upper["rim"], name="pair")))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    guide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1)))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=1e6, damping=2e3, preload=2e3))
    return scene


def bits(history: History) -> bytes:
    arrays = [a for b in history.bodies.values() for a in (b.position, b.rotation)]
    arrays += [c.pressure for c in history.contacts.values()]
    return b"".join(np.ascontiguousarray(a).tobytes() for a in arrays)


def works(body: ReducedBody) -> list[Callable[[], bytes]]:
    """Everything that captures a graph."""
    return [
        lambda: bits(wf.simulate(pendulum(), 0.3, step=1e-3, progress=False).history),
        lambda: bits(
            wf.simulate(pressed(body), 3e-3, step=1e-4, start="equilibrium", progress=False).history  # one shared body
        ),
        lambda: bits(wf.equilibrium(pressed(body)).history),
        lambda: wf.eigenmodes(pressed(body)).frequencies.tobytes(),
    ]


def test_runs_in_threads_are_those_of_one_thread(plain_body: ReducedBody) -> None:
    wanted = [work() for work in works(plain_body)]
    with ThreadPoolExecutor(THREADS) as pool:
        jobs = [[pool.submit(work) for work in works(plain_body)] for _ in range(3)]
        found = [[job.result(timeout=300) for job in round_] for round_ in jobs]
    assert all(got == wanted for got in found)


def test_replays_leave_the_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another thread gets the turn while a graph replays."""
    assert replays_side_by_side("cpu")
    got = []
    launch = wp.capture_launch

    def launched(graph: Any) -> None:
        other = threading.Thread(target=lambda: got.append(_taken()))
        other.start()
        other.join()
        launch(graph)

    monkeypatch.setattr(wp, "capture_launch", launched)
    wf.simulate(pendulum(), 2e-3, step=1e-3, progress=False)
    assert got and all(got)
    got.clear()
    monkeypatch.setattr(wp.config, "enable_cpu_blocks", True)
    assert not replays_side_by_side("cpu")


def _taken() -> bool:
    """Whether this thread can have the turn at once."""
    free = WARP_LOCK._lock.acquire(timeout=5.0)
    if free:
        WARP_LOCK._lock.release()
    return free


def test_a_turn_is_taken_again_and_left_as_a_whole() -> None:
    turn = WarpLock()
    with turn.left():  # nothing to leave
        assert not turn._lock.locked()
    with turn:
        with turn:
            with turn.left():
                assert not turn._lock.locked()
                with turn:
                    assert turn._lock.locked()
            assert turn._lock.locked()
        assert turn._lock.locked()
    assert not turn._lock.locked()
    with pytest.raises(RuntimeError), turn, turn.left():
        raise RuntimeError
    assert not turn._lock.locked()


def test_an_interruption_while_waiting_keeps_the_turn() -> None:
    class Interrupted:
        """A lock that is interrupted once."""

        def __init__(self) -> None:
            self.times = 0

        def acquire(self) -> None:
            self.times += 1
            if self.times == 2:
                raise KeyboardInterrupt

        def release(self) -> None: ...

    turn = WarpLock()
    turn._lock = Interrupted()  # type: ignore[assignment]
    with pytest.raises(KeyboardInterrupt), turn:
        try:
            with turn.left():
                pass
        finally:
            assert turn._mine() and turn._depth == 1
    assert not turn._mine()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
def test_a_fork_waits_for_the_turn() -> None:
    """A child that is forked while another thread has the turn can take it."""
    has, go = threading.Event(), threading.Event()

    def hold() -> None:
        with WARP_LOCK:
            has.set()
            go.wait(5.0)

    thread = threading.Thread(target=hold)
    thread.start()
    has.wait()
    threading.Timer(0.2, go.set).start()
    child = os.fork()
    if not child:
        os._exit(0 if _taken() else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    thread.join()
