"""Oil films: the law by itself, elastic walls, the engine's grids and its acceptance."""
