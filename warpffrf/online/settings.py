"""Named tolerances and sizes of the engine, each with its reason."""

from __future__ import annotations

from dataclasses import dataclass

LARGEST_INDEX = 2**31 - 1  # kernels count in 32-bit integers


@dataclass(frozen=True)
class Settings:
    """What the step graph is built with."""

    residual_tolerance: float = 1e-9  # of the contact force (gaps: of the penetration); promised is 1e-8
    max_iterations: int = 12  # Newton is quadratic: more means a step that is too long
    max_inner: int = 40  # active-set corrections of one linearisation before the safeguard: more means that it cycles
    max_guarded: int = 400  # corrections one hat at a time after that: a window of hats, each changed a few times
    max_level: int = 14  # a step may be halved this often (1/16384)
    # of the energy at hand, gained by the integrator in a step of an impact; with inertia of the local modes, gained or
    # lost by contact and integrator
    energy_tolerance: float = 2.5e-4
    most_made: float = 0.01  # of the largest energy: a run ends that makes more from nowhere; 0: none does
    theta_points: int = 3  # Gauss points across a grid cell: the second grid's hats have kinks inside the cell
    z_points: int = 2  # Gauss points along a grid cell: exact for products of two linear hats
    window_strain: float = 0.07  # half of the default window over the pair's effective radius (Hertz: p0 = 0.035 E*)
    force_points: bool = False  # gaps at points for every pair: to compare the two families of `at_points`
    ring_rows: int = 512  # saved steps a chunk can hold
    start_fraction: float = 1e-3  # of the user's step: the tiny steps of `start`, which refines what they find
    chunk_seconds: float = 0.05  # wall time of a replay, so that Ctrl-C and the progress bar stay quick
