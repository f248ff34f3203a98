"""Constants of small-sliding contacts, a topic of the model."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, matrices, reals, topic, vectors

WORDS = 14  # control words per group of contacts, see `matched.status_words`
NUMBERS = 8  # saved values per cell, see `matched.history`


@topic
class Matched:
    """Small-sliding contacts, see the kernels of `matched`. Contacts that share a body form a group, which
    is solved as one system; cells, motion coordinates and retained columns are stored group by group. Frames of the
    motion are those of the first body."""

    count: int  # groups
    matched: int
    components: DeviceArray = integers("matched_group", note="forces of a cell: 3, or 1 without friction")
    yields: DeviceArray = reals("matched_group", unit="m/N", note="what gaps and forces are compared by")
    matched_start: DeviceArray = integers("matched_group+1")
    cell_start: DeviceArray = integers("matched_group+1")
    column_start: DeviceArray = integers("matched_group+1", note="into the coordinates of motion")
    line_start: DeviceArray = integers("matched_group+1", note="into what each line of a tableau has one of")
    table_start: DeviceArray = integers("matched_group+1", note="into matched_table: (column, line)")
    square_start: DeviceArray = integers("matched_group+1", note="into matched_stiffness: (column, column)")
    retained_start: DeviceArray = integers("matched_group+1", note="into the retained columns of its bodies")
    followed_start: DeviceArray = integers(
        "matched_group+1", note="into matched_followed: (retained column, coordinate)"
    )
    differing_start: DeviceArray = integers("matched_group+1", note="into lines of cells that differ, as many as may")
    factor_start: DeviceArray = integers("matched_group+1", note="into matched_factor: (column, line)")
    update_start: DeviceArray = integers(
        "matched_group+1", note="into matched_left, matched_right: (line that differs, line)"
    )
    compliance_start: DeviceArray = integers("matched_group", note="into compliance: (column, line)")
    motion_start: DeviceArray = integers("matched_group", note="into motion: (coordinate, line)")
    first: DeviceArray = integers("matched", note="body, -1 the ground")
    second: DeviceArray = integers("matched", note="body, -1 the ground")
    rigid_column: DeviceArray = integers("matched", note="its first coordinate d, theta; -1 within a body")
    first_point: DeviceArray = vectors("matched", unit="m", note="rho_A")
    second_point: DeviceArray = vectors("matched", unit="m", note="rho_B, axes of the second body")
    turn: DeviceArray = matrices("matched", note="R_0")
    friction: DeviceArray = reals("matched_cell", note="coefficient mu")
    gap: DeviceArray = reals("matched_cell", unit="m", note="where the scene begins, less the interference")
    own: DeviceArray = reals("matched_cell", unit="m/N", note="compliance along the face")
    column_mode: DeviceArray = integers("matched_column", note="mode that a coordinate is, -1 of a rigid one")
    retained: DeviceArray = integers("matched_retained", note="retained unknown")
    retained_column: DeviceArray = integers(
        "matched_retained", note="coordinate that it is within the group, -1 of a rigid one"
    )
    compliance: DeviceArray = reals("matched_compliance_entry", unit="m/N", note="G")
    motion: DeviceArray = reals("matched_motion_entry", note="J")
