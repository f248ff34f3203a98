"""Scenes as TOML files: the same calls and the same names as from Python; see docs/scene_file.md."""

from warpffrf.scene_file.load import LoadedScene, load_scene, run_scene

__all__ = ["LoadedScene", "load_scene", "run_scene"]
