"""Saved rows of a run, by topic: one ring per array, see `warpffrf.online.arrays.ring`.

Frames are those of the state: centres of mass, body axes.
"""

from warpffrf_kernels.core.declaration import DeviceArray, integers, quaternions, reals, topic, vectors
from warpffrf_kernels.core.films import HEATS as FILM_HEATS
from warpffrf_kernels.core.films import NUMBERS as FILM_NUMBERS
from warpffrf_kernels.core.lumped import NUMBERS
from warpffrf_kernels.core.matched import NUMBERS as MATCHED_NUMBERS


@topic
class SavedBooks:
    """Time, counts and the ledger."""

    saved_time: DeviceArray = reals("world", "ring_row", unit="s")
    saved_step: DeviceArray = reals("world", "ring_row", unit="s", note="size of the step that led here")
    saved_iterations: DeviceArray = integers("world", "ring_row", note="of the steps since the last row")
    saved_solves: DeviceArray = integers("world", "ring_row", note="of the active nodes, likewise")
    saved_energy: DeviceArray = reals("world", "ring_row", "line", unit="J")


@topic
class SavedMotion:
    """Bodies, modes, and rows of joints, drives and springs."""

    saved_r: DeviceArray = vectors("world", "ring_row", "body", unit="m")
    saved_p: DeviceArray = quaternions("world", "ring_row", "body")
    saved_v: DeviceArray = vectors("world", "ring_row", "body", unit="m/s")
    saved_omega: DeviceArray = vectors("world", "ring_row", "body", unit="rad/s")
    saved_v_rate: DeviceArray = vectors("world", "ring_row", "body", unit="m/s2")
    saved_omega_rate: DeviceArray = vectors("world", "ring_row", "body", unit="rad/s2")
    saved_q: DeviceArray = reals("world", "ring_row", "mode", unit="m kg^1/2")
    saved_qd: DeviceArray = reals("world", "ring_row", "mode", unit="m kg^1/2/s")
    saved_qd_rate: DeviceArray = reals("world", "ring_row", "mode", unit="m kg^1/2/s2")
    saved_coordinate: DeviceArray = reals("world", "ring_row", "row", unit="m or rad")
    saved_row_wrench: DeviceArray = reals("world", "ring_row", "row", 6, unit="N, N m", note="on the second body")


@topic
class SavedJointFriction:
    """Friction in joints."""

    saved_slipping: DeviceArray = integers("world", "ring_row", "joint_friction", note="0 stick, 1 slip")
    saved_surface_velocity: DeviceArray = reals("world", "ring_row", "joint_friction", 2, unit="m/s")
    saved_surface_traction: DeviceArray = reals("world", "ring_row", "joint_friction", 2, unit="N")
    saved_slip_bound: DeviceArray = reals("world", "ring_row", "joint_friction", unit="N")
    saved_slip_power: DeviceArray = reals("world", "ring_row", "joint_friction", unit="W", note="of the last step")


@topic
class SavedContact:
    """Contact pairs; wrenches are about the centre of mass of the first body."""

    saved_center: DeviceArray = integers("world", "ring_row", "pair", 2, note="centre columns on A and B")
    saved_column: DeviceArray = reals("world", "ring_row", "pair", unit="columns", note="line of centres on A")
    saved_distance: DeviceArray = reals(
        "world", "ring_row", "pair", unit="m", note="of the axes, or the smallest gap where gaps are taken at points"
    )
    saved_pair_wrench: DeviceArray = reals("world", "ring_row", "pair", 6, unit="N, N m", note="on A")
    saved_second_wrench: DeviceArray = reals("world", "ring_row", "pair", 6, unit="N, N m", note="on B")
    saved_pressure: DeviceArray = reals("world", "ring_row", "pair", "node", unit="Pa")
    saved_active: DeviceArray = integers("world", "ring_row", "pair", note="nodes under pressure")
    saved_second_load: DeviceArray = reals("world", "ring_row", "pair", "second_node", unit="N")
    saved_patch: DeviceArray = reals("world", "ring_row", "patch_pair", "patch_number", note="as patch_place")


@topic
class SavedFriction:
    """Pairs with friction; two directions are stored together, cell by cell."""

    saved_traction: DeviceArray = reals("world", "ring_row", "pair", "2*friction_node", unit="Pa")
    saved_slip_velocity: DeviceArray = reals("world", "ring_row", "pair", "2*friction_node", unit="m/s")
    saved_cell_state: DeviceArray = integers("world", "ring_row", "pair", "friction_node", note="open, stick, slip")
    saved_friction: DeviceArray = reals("world", "ring_row", "friction_pair", 4, note="as friction_record")
    saved_advanced: DeviceArray = reals("world", "ring_row", "friction_pair", unit="columns", note="as most_advanced")


@topic
class SavedLumped:
    """Points of lumped contacts."""

    saved_lumped: DeviceArray = reals(
        "world", "ring_row", "lumped_place", NUMBERS,
        note="place, force, friction (both on the first body) and slip velocity, world axes; approach, normal force",
    )  # fmt: skip
    saved_lumped_moment: DeviceArray = vectors(
        "world", "ring_row", "lumped_moment", unit="N m", note="against rolling and pivoting, on the first body, world"
    )


@topic
class SavedFilms:
    """Oil films."""

    saved_film: DeviceArray = reals("world", "ring_row", "film", FILM_NUMBERS, note="see `films.history`")
    saved_film_pressure: DeviceArray = reals("world", "ring_row", "film_node", unit="Pa")
    saved_film_gap: DeviceArray = reals("world", "ring_row", "film_node", unit="m")
    saved_film_void: DeviceArray = reals("world", "ring_row", "film_node", unit="m")
    saved_film_asperity: DeviceArray = reals("world", "ring_row", "film_node", unit="Pa")
    saved_film_temperature: DeviceArray = reals("world", "ring_row", "film_heat_node", unit="degC")
    saved_film_heat: DeviceArray = reals("world", "ring_row", "film", FILM_HEATS, note="see `films.heat`")
    saved_film_second: DeviceArray = reals("world", "ring_row", "film_second_node", unit="N")


@topic
class SavedMatched:
    """Cells of joint interfaces."""

    saved_matched: DeviceArray = reals(
        "world", "ring_row", "matched_cell", MATCHED_NUMBERS, note="see `matched.history`"
    )
