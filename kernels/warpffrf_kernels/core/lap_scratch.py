"""Scratch arrays of joint interfaces: tableaus of groups, cell states and values, loads on bodies and modes."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, matrices, reals, topic
from warpffrf_kernels.core.laps import WORDS as LAP_WORDS


@topic
class LapScratch:
    """Joint interfaces, see the kernels of `laps`."""

    lap_words: DeviceArray = integers("world", "lap_group", LAP_WORDS, note="see `laps.words`", carried=True)
    lap_z: DeviceArray = reals("world", "lap_column", note="coordinates of the motion that laps see", carried=True)
    lap_step: DeviceArray = reals("world", "lap_column", note="their change since the evaluation before")
    lap_mode: DeviceArray = integers("world", "lap_cell", note="state, see `laps.forms`", carried=True)
    lap_target_form: DeviceArray = reals("world", "lap_cell", 3, note="direction of the traction, kappa", carried=True)
    lap_request: DeviceArray = integers("world", "lap_cell", note="what it is to become, see `laps.words`")
    lap_next: DeviceArray = reals("world", "lap_cell", 3, note="direction and kappa that it is to have")
    lap_reversals: DeviceArray = integers("world", "lap_cell", note="times that it has closed in an evaluation")
    lap_u: DeviceArray = reals("world", "lap_line", note="independent numbers", run=True, carried=True)
    lap_v: DeviceArray = reals("world", "lap_line", note="dependent numbers", run=True, carried=True)
    lap_target: DeviceArray = reals("world", "lap_line", note="where u should be", run=True)
    lap_guess: DeviceArray = reals("world", "4*lap_line", note="u of earlier passes", run=True)
    lap_rest: DeviceArray = reals("world", "4*lap_line", note="their steps", run=True)
    lap_list: DeviceArray = integers("world", "lap_line", note="columns to be added", flat=True)
    lap_given: DeviceArray = reals("world", "lap_line", note="by how much", run=True)
    lap_base: DeviceArray = integers("world", "lap_cell", note="state that the table was made for", carried=True)
    lap_base_target_form: DeviceArray = reals("world", "lap_cell", 3, note="likewise direction, kappa", carried=True)
    lap_table: DeviceArray = reals("world", "lap_number", note="tableau, by columns", run=True, carried=True)
    lap_slot: DeviceArray = integers("world", "lap_cell", note="among cells that differ, or -1", carried=True)
    lap_place: DeviceArray = integers(
        "world", "lap_line", note="among lines that differ, or -1", carried=True, flat=True
    )
    lap_owner: DeviceArray = integers(
        "world", "lap_differing", note="first lines of such cells", carried=True, flat=True
    )
    lap_active: DeviceArray = integers("world", "lap_differing", note="such lines", carried=True, flat=True)
    lap_rows: DeviceArray = reals("world", "3*lap_differing", note="their lines of b", carried=True, flat=True)
    lap_units: DeviceArray = reals("world", "2*lap_differing", note="of u', u of such lines", run=True, carried=True)
    lap_maps: DeviceArray = matrices("world", "3*lap_differing", note="a, c, d of such cells", carried=True, flat=True)
    lap_factor: DeviceArray = reals("world", "lap_factor_number", note="of M, by columns", carried=True, flat=True)
    lap_pivot: DeviceArray = integers("world", "lap_differing", note="of M", carried=True, flat=True)
    lap_weight: DeviceArray = reals("world", "lap_differing", note="their independent numbers", run=True)
    lap_before: DeviceArray = reals("world", "3*lap_differing", note="v of such cells so far", run=True)
    lap_left: DeviceArray = reals("world", "lap_update", note="columns of the table", run=True)
    lap_right: DeviceArray = reals("world", "lap_update", note="M^-1 R", run=True)
    lap_strip: DeviceArray = reals("world", "lap_line", note="G s + J z", run=True)
    lap_trial: DeviceArray = reals("world", "lap_line", unit="N", note="forces", run=True, carried=True)
    lap_moved: DeviceArray = reals("world", "lap_line", unit="m", note="gaps and slips of the step", run=True)
    lap_gradient: DeviceArray = reals("world", "lap", 6, 12, note="of d, theta by the motion of its bodies")
    lap_push: DeviceArray = reals("world", "lap_column", note="forces on the coordinates", zero_without=True)
    lap_sum: DeviceArray = reals("world", "lap_column", note="sizes of their parts", zero_without=True)
    lap_stored: DeviceArray = reals("world", "lap_group", unit="J")
    lap_taken: DeviceArray = reals("world", "lap_group", 2, unit="J", note="by friction, rest", zero_without=True)
    lap_off: DeviceArray = reals("world", "lap_group", note="what forces have not settled", zero_without=True)
    lap_depth: DeviceArray = reals(
        "world", "lap_group", unit="m", note="that the largest force yields", zero_without=True
    )
    lap_stiffness: DeviceArray = reals("world", "lap_square", note="T_zz", run=True, carried=True)
    lap_followed: DeviceArray = reals("world", "lap_followed", note="T_zz B", run=True)
