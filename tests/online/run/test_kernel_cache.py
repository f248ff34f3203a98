"""The cache of compiled kernels: what is damaged or was not finished is compiled anew, never loaded."""

from __future__ import annotations

import logging
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import warp as wp

from warpffrf.model.errors import InputError
from warpffrf.online.step import kernel_cache

MODULE = SimpleNamespace(name="some.kernels")
ENDED = 2**22 - 1  # no process has this number where the largest is the usual 2^22


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(wp.config, "kernel_cache_dir", str(tmp_path))
    monkeypatch.setattr(kernel_cache, "_known", {})
    return tmp_path


def compiled(cache: Path, content: bytes = b"object") -> bool:
    """Load MODULE as Warp does: compile what is not there. Returns whether that was needed."""
    folder = cache / "wp_some.kernels_0123abc"
    with kernel_cache.sound(MODULE):
        needed = not folder.is_dir()
        folder.mkdir(exist_ok=True)
        for name in ("k.o", "k.meta", "k.cpp"):
            if not (folder / name).is_file():
                (folder / name).write_bytes(content)
    kernel_cache._known.clear()  # as another process
    return needed


def test_what_is_whole_stays(cache: Path) -> None:
    assert compiled(cache) and not compiled(cache)


@pytest.mark.parametrize("name", ["k.o", "k.meta", kernel_cache.SEAL])
@pytest.mark.parametrize("damage", ["a bit", "empty", "gone"])
def test_damage_is_compiled_anew(cache: Path, name: str, damage: str, caplog: pytest.LogCaptureFixture) -> None:
    compiled(cache)
    path = cache / "wp_some.kernels_0123abc" / name
    content = path.read_bytes()
    if damage == "gone":
        path.unlink()
    else:
        path.write_bytes(b"" if damage == "empty" else bytes([content[0] ^ 1]) + content[1:])
    with caplog.at_level(logging.INFO, "warpffrf"):
        assert compiled(cache) and not compiled(cache)
    assert "wp_some.kernels_0123abc" in caplog.text and "compiled anew" in caplog.text


def test_sources_and_other_modules_are_left_alone(cache: Path) -> None:
    compiled(cache)
    (cache / "wp_some.kernels_0123abc" / "k.cpp").write_bytes(b"changed")
    others = [cache / "wp_some.kernels.more_0123abc", cache / "wp_some_0123abc"]
    for other in others:
        other.mkdir()
    assert not compiled(cache) and all(other.is_dir() for other in others)


def test_nothing_is_sealed_after_an_error(cache: Path) -> None:
    with pytest.raises(ZeroDivisionError), kernel_cache.sound(MODULE):
        (cache / "wp_some.kernels_0123abc").mkdir()
        raise ZeroDivisionError
    assert compiled(cache)


def test_a_cache_that_may_not_be_written_to(
    cache: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Without seals it is used as it is; damage that a seal shows is reported."""

    def refuse(folder: Path) -> None:
        raise PermissionError(13, "Permission denied")

    compiled(cache)
    monkeypatch.setattr(shutil, "rmtree", refuse)
    folder = cache / "wp_some.kernels_0123abc"
    (folder / kernel_cache.SEAL).rename(folder / "elsewhere")
    assert not compiled(cache) and "used as it is" in caplog.text
    (folder / "k.o").write_bytes(b"changed")
    with pytest.raises(InputError, match="is damaged and cannot be removed .*Permission denied.*WARP_CACHE_PATH"):
        compiled(cache)


def test_what_killed_compilations_left_is_removed(cache: Path) -> None:
    old = time.time() - 2 * kernel_cache.UNFINISHED_FOR
    folders = {number: cache / f"wp_some.kernels_0123abc_p{number}_t17" for number in (ENDED, ENDED - 1, os.getpid())}
    for number, folder in folders.items():
        folder.mkdir()
        (folder / "k.cpp").write_text("half")
        if number != ENDED - 1:
            os.utime(folder, (old, old))
    kernel_cache.remove_unfinished()
    left = {number for number, folder in folders.items() if folder.is_dir()}
    assert left == {ENDED - 1, os.getpid()}  # too new, and of a process that lives


def test_processors_of_two_kinds_share_a_folder(cache: Path) -> None:
    """Warp compiles for the processor and keeps its objects side by side in the folder of the module."""
    assert compiled(cache)
    for name in ("k.other.o", "k.third.o"):  # the second by a process that has verified the folder before
        with kernel_cache.sound(MODULE):
            (cache / "wp_some.kernels_0123abc" / name).write_bytes(b"object")
    kernel_cache._known.clear()  # as another process
    assert not compiled(cache)
    assert (cache / "wp_some.kernels_0123abc" / "k.other.o").is_file()


START = """
from warpffrf.model.errors import InputError
from warpffrf.online.warp_start import start_warp
try:
    start_warp()
except InputError as error:
    print(error)
"""


@pytest.mark.parametrize("variable", ["WARP_CACHE_PATH", "HOME"])
def test_a_folder_that_cannot_be_made_is_said(tmp_path: Path, variable: str) -> None:
    """That of the variable, or Warp's own in a home directory that is missing or read-only."""
    (tmp_path / "file").write_text("")
    env = {name: value for name, value in os.environ.items() if name not in ("WARP_CACHE_PATH", "XDG_CACHE_HOME")}
    env[variable] = str(tmp_path / "file" / "below")
    done = subprocess.run([sys.executable, "-c", START], env=env, capture_output=True, text=True)
    assert "kernels: they cannot be kept in" in done.stdout and "WARP_CACHE_PATH" in done.stdout, done.stderr


def test_kernels_that_cannot_be_written_are_said(cache: Path) -> None:
    with pytest.raises(InputError, match="cannot be kept in .*Read-only.*WARP_CACHE_PATH"):
        with kernel_cache.sound(MODULE):
            raise OSError(30, "Read-only file system")


RUN = """
import logging
import warpffrf as wf
logging.basicConfig()
scene = wf.Scene(gravity=(0, 0, -9.81))
bob = scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="bob", position=(0.5, 0, 0))
scene.add(wf.joints.Revolute(scene.ground, bob.at((-0.5, 0, 0)), axis=(0, 1, 0)))
print(repr(wf.simulate(scene, 0.05, step=1e-3, progress=False).body("bob").position[-1].tolist()))
"""


@pytest.mark.slow
@pytest.mark.parametrize("damage", ["bits", "cut", "empty", "zeros"])
def test_a_run_with_a_damaged_object_is_the_same_run(tmp_path: Path, damage: str) -> None:
    """A process of its own: a damaged object that is loaded ends the process."""
    mine = Path(os.environ["WARP_CACHE_PATH"])
    env = {**os.environ, "WARP_CACHE_PATH": str(mine)}
    command = [sys.executable, "-c", RUN]
    whole = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
    shutil.copytree(mine, tmp_path / "cache", ignore=lambda _, names: [n for n in names if n.endswith(".cpp")])
    objects = sorted((tmp_path / "cache").glob("*/wp_warpffrf_kernels.step.balance_*/*.o"))
    assert objects
    for path in objects:
        data = bytearray(path.read_bytes())
        n = len(data)
        if damage == "bits":
            for at in range(n // 8, n // 2, 97):
                data[at] ^= 4
        elif damage == "zeros":
            data[n // 4 : n // 2] = bytes(n // 2 - n // 4)
        path.write_bytes({"cut": data[: n // 2], "empty": b""}.get(damage, data))
    env["WARP_CACHE_PATH"] = str(tmp_path / "cache")
    again = subprocess.run(command, env=env, capture_output=True, text=True)
    assert again.returncode == 0 and again.stdout == whole.stdout, again.stderr[-2000:]
    assert "compiled anew" in again.stderr
