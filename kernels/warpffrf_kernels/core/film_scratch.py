"""Scratch arrays of oil films."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, reals, topic
from warpffrf_kernels.core.films import HEAT_LINE, NODE_LINE, PULL, SUMS
from warpffrf_kernels.core.films import LINE as FILM_LINE
from warpffrf_kernels.core.scratch import MODAL


@topic
class FilmScratch:
    """Oil films, see the kernels of `films`."""

    film_stretch: DeviceArray = reals("world", note="time of films over that of bodies in static steps", carried=True)
    film_rates: DeviceArray = reals("world", 3, unit="1/s", note="coefficients of BDF2")
    film_least: DeviceArray = reals("world", "film_point", unit="m", note="by which the prediction closes gaps")
    film_acting: DeviceArray = reals("world", "film_system", unit="Pa", note="pressures that deform", run=True)
    film_opened: DeviceArray = reals("world", "film_node", unit="m", note="by deformation")
    film_local: DeviceArray = reals("world", "film_node", unit="m", note="of this by local modes", run=True)
    film_seat: DeviceArray = integers("world", "film_seat", 2, note="nodes of the second surface, see `films.seats`")
    film_seat_at: DeviceArray = reals("world", "film_seat", 2, note="where between them")
    film_press_load: DeviceArray = reals("world", "film_press", unit="N", note="by pressures and asperities")
    film_second_load: DeviceArray = reals(
        "world", "film_second_node", unit="N", note="on nodes of the second surface", flat=True
    )
    film_second_opened: DeviceArray = reals(
        "world", "film_second_node", unit="m", note="there, by deformation", flat=True
    )
    film_second_energy: DeviceArray = reals("world", "film_second_node", unit="J", note="of its local modes")
    film_carried: DeviceArray = reals("world", "film_function", 2, unit="m/s", note="U: around, along")
    film_mass_now: DeviceArray = reals("world", "film_point", unit="m", note="of the trial state")
    film_line: DeviceArray = reals("world", "film_point", FILM_LINE, note="numbers of a point, see `films.sampling`")
    film_pull: DeviceArray = reals("world", "film_point", PULL, note="forces and powers of a point")
    film_sums: DeviceArray = reals("world", "film", SUMS, note="of all points", zero_without=True)
    film_rest: DeviceArray = reals("world", "film_function", unit="m3/s", note="R")
    film_size: DeviceArray = reals("world", "film_function", unit="m3/s", note="of its parts")
    film_refill: DeviceArray = reals("world", "film_function", unit="m3/s", note="part of the voids in R")
    film_off: DeviceArray = reals("world", "film", note="R beside its parts", zero_without=True)
    film_off_before: DeviceArray = reals("world", "film", note="of the iteration before", carried=True)
    film_modal: DeviceArray = reals("world", "film_column", unit=MODAL, note="load on modes", zero_without=True)
    film_changed: DeviceArray = integers("world", "film", note="functions that changed sides", zero_without=True)
    film_node_line: DeviceArray = reals("world", "film_node", NODE_LINE, note="where there are asperities")
    film_energy_now: DeviceArray = reals("world", "film_node", unit="J/m2", note="of asperities")
    film_rough: DeviceArray = integers("world", "film_node", note="1 where asperities touch", carried=True)
    film_wide: DeviceArray = reals("world", "film_near", unit="m2/s", note="dR by the gap at stations")
    film_matrix: DeviceArray = reals(
        "world", "film_number", note="lines of `films.lines`, then their factors and solutions", run=True, carried=True
    )
    film_place: DeviceArray = integers(
        "world", "film_system", note="place in the elimination, -1: none", flat=True, carried=True
    )
    film_pivots: DeviceArray = integers(
        "world", "film_system", note="lines that changed places", flat=True, carried=True
    )
    film_scale: DeviceArray = reals(
        "world", "film_system", note="by which a line is multiplied", run=True, carried=True
    )
    film_extent: DeviceArray = integers(
        "world", "film", 3, note="half the band, lines in it, lines of the seam", carried=True, zero_without=True
    )
    film_opening_place: DeviceArray = integers(
        "world", "film_place", note="places of pressures that open gaps, -1: of others", flat=True
    )
    film_pressing_place: DeviceArray = integers(
        "world", "film_place", note="places of pressures of full functions, -1: of others", flat=True
    )
    film_room: DeviceArray = reals("world", "film_room", note="room of each line", run=True)
    film_moved: DeviceArray = reals(
        "world", "film_moved", note="S Phi_B: second smooth functions at stations", run=True, carried=True
    )
    film_moved_load: DeviceArray = reals(
        "world", "film_moved_load", unit="m2", note="force on them of a pressure", run=True, carried=True
    )
    film_moved_close: DeviceArray = reals(
        "world", "film_moved_close", unit="m/Pa", note="near part of the second surface", run=True, carried=True
    )
    film_moved_room: DeviceArray = reals("world", "film_moved_room", note="room of each station", run=True)
    film_motion: DeviceArray = reals(
        "world", "film_smooth_column", note="Z: opening by the coupled columns", run=True, carried=True
    )
    film_port: DeviceArray = reals(
        "world", "film_port_number", note="1 + K C, (1 + K C)^-1 K, (1 + K C)^-1", run=True, carried=True
    )
    film_port_pivots: DeviceArray = integers("world", "film_smooth", note="lines that changed places", flat=True)
    film_load: DeviceArray = reals("world", "film_load_number", note="P^T T^-1 U, P^T T^-1 R", run=True, carried=True)
    film_opened_smooth: DeviceArray = reals("world", "film_smooth", unit="m", note="of smooth functions", run=True)
    film_force: DeviceArray = reals("world", "film_smooth", unit="N", note="on smooth functions", run=True)
    film_amount: DeviceArray = reals("world", "film_smooth", unit="m", note="of smooth functions", run=True)
    film_stiffness: DeviceArray = reals("world", "film_square", note="of the film to its columns", carried=True)
    film_push: DeviceArray = reals("world", "film_column", note="force on them")
    film_spread: DeviceArray = reals("world", "film_place", unit="Pa", note="of pressures, by columns", run=True)
    film_change: DeviceArray = reals("world", "film_system", note="of pressures or voids", run=True)
    film_opening: DeviceArray = reals("world", "film_station", unit="m", note="change of the gap")
    film_ahead: DeviceArray = reals("world", "film_point", unit="m", note="change of the gap")
    film_part: DeviceArray = reals("world", note="of the increments that is taken")
    film_heat_line: DeviceArray = reals("world", "film_heat_node", HEAT_LINE, note="see `films.heat`")
    film_taken: DeviceArray = reals("world", "film", 2, unit="J", note="by flow, by sliding", zero_without=True)
