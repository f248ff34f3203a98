"""Examples, one script each: `python demos/NAME.py` in a checkout, `warpffrf demo NAME` anywhere."""
