"""Geometry shared by results and pictures: view of the scene, poses, contact grids, thinned skins."""
