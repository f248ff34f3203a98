"""Demos that come with the package; `warpffrf demo NAME` runs them, `demos/NAME.py` does from a checkout."""
