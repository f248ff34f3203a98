"""Constants of joint interfaces, a topic of the model."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, matrices, reals, topic, vectors

WORDS = 14  # control words per group of interfaces, see `laps.words`
NUMBERS = 8  # saved values per cell, see `laps.keeping`


@topic
class Laps:
    """Joint interfaces with small sliding, see the kernels of `laps`. Interfaces that share a body form a group, which
    is solved as one system; cells, motion coordinates and retained columns are stored group by group. Frames of the
    motion are those of the first body."""

    count: int  # groups
    laps: int
    components: DeviceArray = integers("lap_group", note="forces of a cell: 3, or 1 without friction")
    yields: DeviceArray = reals("lap_group", unit="m/N", note="what gaps and forces are compared by")
    lap_start: DeviceArray = integers("lap_group+1")
    cell_start: DeviceArray = integers("lap_group+1")
    column_start: DeviceArray = integers("lap_group+1", note="into the coordinates of motion")
    line_start: DeviceArray = integers("lap_group+1", note="into what each line of a tableau has one of")
    table_start: DeviceArray = integers("lap_group+1", note="into lap_table: (column, line)")
    square_start: DeviceArray = integers("lap_group+1", note="into lap_stiffness: (column, column)")
    retained_start: DeviceArray = integers("lap_group+1", note="into the retained columns of its bodies")
    followed_start: DeviceArray = integers("lap_group+1", note="into lap_followed: (retained column, coordinate)")
    differing_start: DeviceArray = integers("lap_group+1", note="into lines of cells that differ, as many as may")
    factor_start: DeviceArray = integers("lap_group+1", note="into lap_factor: (column, line)")
    update_start: DeviceArray = integers("lap_group+1", note="into lap_left, lap_right: (line that differs, line)")
    compliance_start: DeviceArray = integers("lap_group", note="into compliance: (column, line)")
    motion_start: DeviceArray = integers("lap_group", note="into motion: (coordinate, line)")
    first: DeviceArray = integers("lap", note="body, -1 the ground")
    second: DeviceArray = integers("lap", note="body, -1 the ground")
    rigid_column: DeviceArray = integers("lap", note="its first coordinate d, theta; -1 within a body")
    first_point: DeviceArray = vectors("lap", unit="m", note="rho_A")
    second_point: DeviceArray = vectors("lap", unit="m", note="rho_B, axes of the second body")
    turn: DeviceArray = matrices("lap", note="R_0")
    friction: DeviceArray = reals("lap_cell", note="coefficient mu")
    gap: DeviceArray = reals("lap_cell", unit="m", note="where the scene begins, less the interference")
    own: DeviceArray = reals("lap_cell", unit="m/N", note="compliance along the face")
    column_mode: DeviceArray = integers("lap_column", note="mode that a coordinate is, -1 of a rigid one")
    retained: DeviceArray = integers("lap_retained", note="retained unknown")
    retained_column: DeviceArray = integers(
        "lap_retained", note="coordinate that it is within the group, -1 of a rigid one"
    )
    compliance: DeviceArray = reals("lap_compliance_entry", unit="m/N", note="G")
    motion: DeviceArray = reals("lap_motion_entry", note="J")
