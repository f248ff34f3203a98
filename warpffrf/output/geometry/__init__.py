"""Where things are that results and pictures share: what is known of the scene, poses, contact grids, thinned skins."""
