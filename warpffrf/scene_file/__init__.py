"""Scenes as TOML files, with the calls and names of the Python API; `reference()` returns the reference page."""

from warpffrf.scene_file.load import LoadedScene, load_scene, run_scene
from warpffrf.scene_file.manual import reference

__all__ = ["LoadedScene", "load_scene", "reference", "run_scene"]
