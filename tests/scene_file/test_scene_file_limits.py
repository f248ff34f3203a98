"""Scene files that are hostile, or wrong by orders of magnitude: refused at once; nothing is read or written
elsewhere."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf

BASE = """[scene]
gravity = [0, 0, -9.81]
[bodies.bob]
mass = 2.0
inertia_tensor = [0.01, 0.01, 0.01]
"""
RUN = "[simulate]\nduration = 0.002\nstep = 1e-3\n"
SECONDS = 5.0  # of the processor, whatever else it does: what multiplies takes hours
SIZE = "outer_radius = 0.05\nwidth = 0.02"


def refused(tmp_path: Path, text: str, message: str) -> str:
    file = tmp_path / "s.toml"
    file.write_text(text)
    start = time.process_time()
    with pytest.raises(wf.InputError, match=message) as refusal:
        wf.load_scene(file)
    assert time.process_time() - start < SECONDS
    assert len(str(refusal.value)) < 1000 and "s.toml" in str(refusal.value)
    return str(refusal.value)


def laughs(levels: int) -> str:
    lines = ["[parameters]", "l0 = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    for k in range(1, levels + 1):
        lines.append(f"l{k} = [" + ", ".join([f'"= l{k - 1}"'] * 10) + "]")
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("used", ['gravity = "= l8"', 'gravity = [0, 0, "= l8"]', 'gravity = [0, 0, "= 1 + l8"]'])
def test_lists_that_multiply(tmp_path: Path, used: str) -> None:
    refused(tmp_path, laughs(8) + BASE.replace("gravity = [0, 0, -9.81]", used), "contains more than 1000000 values")


def test_lists_that_multiply_in_the_document_itself(tmp_path: Path) -> None:
    text = laughs(4) + BASE + "[meshes.m]\nkind = 'box'\nsize = [" + ", ".join(['"= l4"'] * 20) + "]\n"
    refused(tmp_path, text, "contains more than 1000000 values, with parameters substituted")


@pytest.mark.parametrize("text", ["a" + ".a" * 20000 + " = 1\n", "x = 1\n[t]\n'b'" + ' . "a"' * 500 + " = 1\n"])
def test_keys_of_thousands_of_parts(tmp_path: Path, text: str) -> None:
    refused(tmp_path, text, "nested too deeply")


def test_long_lists_and_many_keys_are_read(tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    many = "".join(f"k{n} = {n}\n" for n in range(2000))
    file.write_text("[parameters]\nx = [" + "1," * 200_000 + "]\n" + many + BASE)
    start = time.process_time()
    assert wf.load_scene(file).scene.bodies[0].mass == 2.0
    assert time.process_time() - start < 2 * SECONDS


def test_files_that_are_too_long(tmp_path: Path) -> None:
    refused(tmp_path, "# " + "x" * (1 << 22) + "\n", "s.toml: has 4194.* bytes, more than 4194304 are not read")


@pytest.mark.skipif(not Path("/proc/version").exists(), reason="has no /proc")
def test_what_is_no_ordinary_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    refused(tmp_path, 'include = ["pipe.toml"]\n' + BASE, "'pipe.toml' does not exist")
    refused(tmp_path, 'include = ["/dev/zero"]\n' + BASE, "'/dev/zero' does not exist")
    (tmp_path / "s.toml").write_text('include = ["/proc/kmsg"]\n' + BASE)
    with pytest.raises(wf.InputError, match="/proc/kmsg: is not a regular file"):
        wf.load_scene(tmp_path / "s.toml")
    refused(tmp_path, BASE.replace("[0.01, 0.01, 0.01]", '{ file = "/proc/version" }'), "'version' is not a regular")


def test_messages_do_not_show_what_is_in_a_file(tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("1 2\nroot:x:0:0:a password\n")
    said = refused(tmp_path, BASE.replace("[0.01, 0.01, 0.01]", '{ file = "secret" }'), "line 2 is not numeric")
    assert "root" not in said and "password" not in said
    (tmp_path / "s.toml").write_text('include = ["secret"]\n' + BASE)
    with pytest.raises(wf.InputError, match="secret:1: invalid TOML") as refusal:
        wf.load_scene(tmp_path / "s.toml")
    assert "root" not in str(refusal.value) and "password" not in str(refusal.value)


def test_a_npy_file_that_declares_more_than_it_holds(tmp_path: Path) -> None:
    with (tmp_path / "n.npy").open("wb") as file:
        np.lib.format.write_array_header_1_0(file, {"descr": "<f8", "fortran_order": False, "shape": (1 << 40,)})
    refused(tmp_path, BASE.replace("[0.01, 0.01, 0.01]", '{ file = "n.npy" }'), "is not a table of numbers")
    np.save(tmp_path / "n.npy", np.full(3, 0.01))
    (tmp_path / "s.toml").write_text(BASE.replace("[0.01, 0.01, 0.01]", '{ file = "n.npy" }'))
    assert wf.load_scene(tmp_path / "s.toml").scene.bodies[0].mass == 2.0


@pytest.mark.parametrize(
    "mesh",
    [
        "kind = 'box'\nsize = [1, 1, 1]\ncounts = [100000, 100000, 100000]",
        "kind = 'box'\nsize = [1, 1, 1]\ncounts = [2, 2, 4294967297]",
        f"kind = 'roller'\n{SIZE}\ninner_radius = 0.01\nsectors = 3\nlayers = 1\naxial = 900000000",
        f"kind = 'roller'\n{SIZE}\ninner_radius = 0.01\nhalf_width = 1e-12",
        f"kind = 'roller'\n{SIZE}\ninner_radius = 0.0\nsectors = 400000000\nlayers = 3\naxial = 3",
    ],
)
def test_meshes_that_no_memory_holds(tmp_path: Path, mesh: str) -> None:
    refused(tmp_path, BASE + f"[meshes.m]\n{mesh}\n", "cells are more than 5e[+]07; make the cells larger")


@pytest.mark.parametrize("name", ["../x.h5", "/tmp/warpffrf-outside/x.h5", "a/../../x.h5", "link/x.h5"])
def test_results_stay_in_the_output_folder(tmp_path: Path, name: str) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "link").symlink_to(tmp_path)
    (tmp_path / "s.toml").write_text(BASE + RUN + f'results = "{name}"\n')
    with pytest.raises(wf.InputError, match=r"s\.toml:9: \[simulate\]: results '.*' is outside the output folder"):
        wf.run_scene(tmp_path / "s.toml", out=out, progress=False)
    assert not (tmp_path / "x.h5").exists() and not Path("/tmp/warpffrf-outside").exists()


def test_unless_it_is_allowed(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(BASE + RUN + f'results = "{tmp_path}/x.h5"\n')
    wf.run_scene(tmp_path / "s.toml", out=tmp_path / "out", anywhere=True, progress=False)
    assert (tmp_path / "x.h5").is_file()
