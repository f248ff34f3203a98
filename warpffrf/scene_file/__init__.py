"""Scenes as TOML files: the same calls and names as from Python; `reference()` says what may stand in one."""

from warpffrf.scene_file.load import LoadedScene, load_scene, run_scene
from warpffrf.scene_file.manual import reference

__all__ = ["LoadedScene", "load_scene", "reference", "run_scene"]
