"""Scratch arrays of small-sliding contacts: tableaus of groups, cell states and values, loads on bodies and modes."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, matrices, reals, topic
from warpffrf_kernels.core.matched import WORDS as MATCHED_WORDS


@topic
class MatchedScratch:
    """Small-sliding contacts, see the kernels of `matched`."""

    matched_words: DeviceArray = integers(
        "world", "matched_group", MATCHED_WORDS, note="see `matched.status_words`", carried=True
    )
    matched_z: DeviceArray = reals(
        "world", "matched_column", note="coordinates of the motion that small-sliding contacts see", carried=True
    )
    matched_step: DeviceArray = reals("world", "matched_column", note="their change since the evaluation before")
    matched_mode: DeviceArray = integers("world", "matched_cell", note="state, see `matched.forms`", carried=True)
    matched_target_form: DeviceArray = reals(
        "world", "matched_cell", 3, note="direction of the traction, kappa", carried=True
    )
    matched_request: DeviceArray = integers(
        "world", "matched_cell", note="what it is to become, see `matched.status_words`"
    )
    matched_next: DeviceArray = reals("world", "matched_cell", 3, note="direction and kappa that it is to have")
    matched_reversals: DeviceArray = integers("world", "matched_cell", note="times that it has closed in an evaluation")
    matched_u: DeviceArray = reals("world", "matched_line", note="independent numbers", run=True, carried=True)
    matched_v: DeviceArray = reals("world", "matched_line", note="dependent numbers", run=True, carried=True)
    matched_target: DeviceArray = reals("world", "matched_line", note="where u should be", run=True)
    matched_guess: DeviceArray = reals("world", "4*matched_line", note="u of earlier passes", run=True)
    matched_rest: DeviceArray = reals("world", "4*matched_line", note="their steps", run=True)
    matched_list: DeviceArray = integers("world", "matched_line", note="columns to be added", flat=True)
    matched_given: DeviceArray = reals("world", "matched_line", note="by how much", run=True)
    matched_base: DeviceArray = integers(
        "world", "matched_cell", note="state that the table was made for", carried=True
    )
    matched_base_target_form: DeviceArray = reals(
        "world", "matched_cell", 3, note="likewise direction, kappa", carried=True
    )
    matched_table: DeviceArray = reals("world", "matched_number", note="tableau, by columns", run=True, carried=True)
    matched_slot: DeviceArray = integers("world", "matched_cell", note="among cells that differ, or -1", carried=True)
    matched_place: DeviceArray = integers(
        "world", "matched_line", note="among lines that differ, or -1", carried=True, flat=True
    )
    matched_owner: DeviceArray = integers(
        "world", "matched_differing", note="first lines of such cells", carried=True, flat=True
    )
    matched_active: DeviceArray = integers("world", "matched_differing", note="such lines", carried=True, flat=True)
    matched_rows: DeviceArray = reals("world", "3*matched_differing", note="their lines of b", carried=True, flat=True)
    matched_units: DeviceArray = reals(
        "world", "2*matched_differing", note="of u', u of such lines", run=True, carried=True
    )
    matched_maps: DeviceArray = matrices(
        "world", "3*matched_differing", note="a, c, d of such cells", carried=True, flat=True
    )
    matched_factor: DeviceArray = reals(
        "world", "matched_factor_number", note="of M, by columns", carried=True, flat=True
    )
    matched_pivot: DeviceArray = integers("world", "matched_differing", note="of M", carried=True, flat=True)
    matched_weight: DeviceArray = reals("world", "matched_differing", note="their independent numbers", run=True)
    matched_before: DeviceArray = reals("world", "3*matched_differing", note="v of such cells so far", run=True)
    matched_left: DeviceArray = reals("world", "matched_update", note="columns of the table", run=True)
    matched_right: DeviceArray = reals("world", "matched_update", note="M^-1 R", run=True)
    matched_strip: DeviceArray = reals("world", "matched_line", note="G s + J z", run=True)
    matched_trial: DeviceArray = reals("world", "matched_line", unit="N", note="forces", run=True, carried=True)
    matched_moved: DeviceArray = reals("world", "matched_line", unit="m", note="gaps and slips of the step", run=True)
    matched_gradient: DeviceArray = reals("world", "matched", 6, 12, note="of d, theta by the motion of its bodies")
    matched_push: DeviceArray = reals("world", "matched_column", note="forces on the coordinates", zero_without=True)
    matched_sum: DeviceArray = reals("world", "matched_column", note="sizes of their parts", zero_without=True)
    matched_stored: DeviceArray = reals("world", "matched_group", unit="J")
    matched_taken: DeviceArray = reals(
        "world", "matched_group", 2, unit="J", note="by friction, rest", zero_without=True
    )
    matched_off: DeviceArray = reals("world", "matched_group", note="what forces have not settled", zero_without=True)
    matched_depth: DeviceArray = reals(
        "world", "matched_group", unit="m", note="that the largest force yields", zero_without=True
    )
    matched_stiffness: DeviceArray = reals("world", "matched_square", note="T_zz", run=True, carried=True)
    matched_followed: DeviceArray = reals("world", "matched_followed", note="T_zz B", run=True)
