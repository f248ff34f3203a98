"""Named tolerances and sizes of the engine, each with its reason."""

from __future__ import annotations

from dataclasses import dataclass, replace

LARGEST_INDEX = 2**31 - 1  # kernels count in 32-bit integers


@dataclass(frozen=True)
class Settings:
    """Constants that the step graph is built with."""

    residual_tolerance: float = 1e-9  # of the contact force (gaps: of the penetration); the guaranteed value is 1e-8
    max_iterations: int = 12  # Newton is quadratic: more indicates too long a step
    max_inner: int = 40  # active-set corrections of one linearisation before the safeguard: more indicates cycling
    max_guarded: int = 400  # single-node corrections after that: a window of nodes, each changed a few times
    max_level: int = 14  # maximum number of halvings of a step (1/16384)
    # of the present energy, gained by the integrator in an impact step; with inertia of the local modes, gained or
    # lost by contact and integrator
    energy_tolerance: float = 2.5e-4
    gain_limit: float = 0.01  # of the largest energy: a run with a larger spurious gain ends; 0: no limit
    theta_points: int = 3  # Gauss points across a grid cell: the second grid's shape functions have kinks inside
    z_points: int = 2  # Gauss points along a grid cell: exact for products of two linear shape functions
    window_strain: float = 0.07  # half of the default window over the pair's effective radius (Hertz: p0 = 0.035 E*)
    force_points: bool = False  # closest-point kinematics for every contact, to compare both families of `at_points`
    ring_rows: int = 512  # saved steps per chunk
    start_fraction: float = 1e-3  # of the user's step: the small steps of `start`, which refines their result
    chunk_seconds: float = 0.05  # wall time of a replay, so that Ctrl-C and the progress bar respond

    def for_rows(self, rows: int) -> Settings:
        """These for a run that saves `rows` after the first one: rows of the ring, 67 of the 69 MB of a roller bearing
        where there are 512, no more than it needs. The second of two more lets a replay cover the whole run."""
        return replace(self, ring_rows=min(self.ring_rows, rows + 2))
