"""Constant data of a scene on the device, by topic; `warpffrf.online.compile.scene` fills it, docs/arrays.md lists it.

Absent indices are -1. The origin of a body frame is the centre of mass (Tisserand frame). Axes whose names end in
"_entry" belong to concatenated tables.
"""

import warp as wp

from warpffrf_kernels.core.declaration import DeviceArray, integers, matrices, reals, topic, vectors
from warpffrf_kernels.core.films import Films
from warpffrf_kernels.core.lumped import Lumped, Moments
from warpffrf_kernels.core.matched import Matched
from warpffrf_kernels.core.scalars import real, vec3

# --- families of pairs, values of `Pairs.family`: kinematics of the gaps
LINE_OF_CENTRES = wp.constant(0)
AT_POINTS = wp.constant(1)
PATCH = wp.constant(2)  # contact-fixed cells

CONSTANT = wp.constant(0)  # of `Layers.kind`: no layer, or its compliance is constant; others: `layers.layer_laws`


@topic
class Bodies:
    """Rigid parts, and the ranges of each body's modes."""

    count: int
    mass: DeviceArray = reals("body", unit="kg")
    inertia: DeviceArray = matrices("body", unit="kg m2", note="about the centre of mass, body axes")
    modal_start: DeviceArray = integers("body+1", note="first mode")
    global_count: DeviceArray = integers("body", note="modes that move interfaces, the first ones of the body")
    dense_start: DeviceArray = integers("body", note="first mode that is an retained unknown")
    dense_count: DeviceArray = integers("body", note="modes that are retained unknowns, the first ones")
    inertia_count: DeviceArray = integers("body", note="modes that carry inertia, the first of these")
    inertia_start: DeviceArray = integers("body", note="into the table of `Dense`")
    square_start: DeviceArray = integers("body+1", note="first square of the membrane energy")


@topic
class Modes:
    """Modes of all bodies."""

    count: int
    dynamic_count: int  # modes of kind 1 and 2
    top_frequency: real  # rad/s, the highest of all modes
    retained_frequency: real  # rad/s, the highest of kind 0
    stiffness: DeviceArray = reals("mode", unit="rad2/s2", note="omega^2")
    damping: DeviceArray = reals("mode", unit="rad/s", note="2 zeta omega")
    kind: DeviceArray = integers(
        "mode", note="0 the integrator of the retained coordinates's, 1 HHT, 2 exact for a linear load"
    )
    reach: DeviceArray = reals("mode", unit="kg^-1/2", note="largest displacement per unit coordinate")
    dense_of: DeviceArray = integers("mode", note="number among the retained unknowns, -1 for one that is condensed")


@topic
class Dense:
    """Modes that are retained coordinates, the first ones of a body: those that carry inertia, see `inertia`, and all
    global modes of a body loaded on several surfaces, through which its pairs are coupled."""

    count: int
    body: DeviceArray = integers("dense")
    mode: DeviceArray = integers("dense", note="which of all modes")
    first: DeviceArray = reals("dense", 6, unit="kg^1/2 m", note="J1: xx yy zz xy yz zx")
    table: DeviceArray = reals(
        "inertia_entry", note="(9, count, count) a body: J2 in the order of J1, then G_ij with line j, column i"
    )


@topic
class Membrane:
    """Squares of the membrane energy of bodies, each with one form L_r over the modes that carry inertia."""

    count: int
    lines: int  # entries of all lines L_r q
    body: DeviceArray = integers("square")
    table_start: DeviceArray = integers("square", note="into `table`")
    line_start: DeviceArray = integers("square", note="where its line L_r q begins")
    table: DeviceArray = reals("membrane_entry", unit="kg^-1 J^1/2 m^-2", note="(count, count) a square")


@topic
class Retained:
    """The retained unknowns: motions of bodies, modes that are not condensed, multipliers."""

    row_offset: int  # 6 * bodies + these modes
    count: int  # row_offset + rows


@topic
class Interfaces:
    """Flexible interfaces."""

    count: int
    width: int  # largest number of modes that move interfaces
    body: DeviceArray = integers("table_interface")
    point: DeviceArray = vectors("table_interface", unit="m", note="body frame")
    modes: DeviceArray = reals(
        "interface_shape", unit="kg^-1/2", note="(interfaces, 6, width): translation, rotation by the modes"
    )
    reach: DeviceArray = reals("table_interface", 6, note="largest of `modes` over the modes")
    stiffening_start: DeviceArray = integers("table_interface", note="into `stiffening`, -1 without")
    stiffening: DeviceArray = reals(
        "stiffening_entry", note="(6, count, count) an interface: K per unit force and torque"
    )


@topic
class Markers:
    """Joint frames."""

    body: DeviceArray = integers("marker")
    interface: DeviceArray = integers("marker")
    point: DeviceArray = vectors("marker", unit="m", note="body frame, world when on ground")
    axes: DeviceArray = matrices("marker", note="columns x, y, z of the marker in the body frame")


@topic
class Rows:
    """Constraints and springs, c(x, t) = 0 or lambda = k c + d cdot + preload, and characteristics."""

    count: int
    kind: DeviceArray = integers("row", note="see `control`")
    a: DeviceArray = integers("row", note="marker")
    b: DeviceArray = integers("row", note="marker")
    i: DeviceArray = integers("row", note="axis of marker a")
    j: DeviceArray = integers("row", note="axis of marker b")
    signal: DeviceArray = integers("row", note="prescribed motion")
    stiffness: DeviceArray = reals("row", unit="N/m or N m/rad", note="0 for a rigid row")
    damping: DeviceArray = reals("row", unit="N s/m or N m s/rad")
    reference: DeviceArray = reals("row", unit="m or rad", note="subtracted from c")
    preload: DeviceArray = reals("row", unit="N or N m")
    rigid: DeviceArray = integers("row", note="1: constraint, 0: spring")
    group: DeviceArray = integers("row", note="group of a spring row that shares matrices with others")
    elastic: DeviceArray = integers("row", note="characteristic over c, -1 without")
    viscous: DeviceArray = integers("row", note="characteristic over cdot, -1 without")
    vector: DeviceArray = reals("row", 6, note="a bushing coordinate's part of displacement and rotation vector")


@topic
class Groups:
    """Groups of spring rows with lambda = K c + D cdot + preload, see `forces`."""

    count: int
    start: DeviceArray = integers("group", note="first row; the others follow")
    size: DeviceArray = integers("group")
    sprung: DeviceArray = integers("group", note="rows with stiffness, the first ones; the rest are dampers only")
    stiffness: DeviceArray = reals("group", "group_row", "group_row", unit="N/m, N m/rad")
    damping: DeviceArray = reals("group", "group_row", "group_row", unit="N s/m, N m s/rad")


@topic
class JointFrictions:
    """Friction in joints, see `joint_friction`."""

    count: int
    start: DeviceArray = integers("joint_friction", note="its first row; a second one follows")
    size: DeviceArray = integers("joint_friction", note="1 or 2 rows")
    weight: DeviceArray = reals("joint_friction", 2, unit="1 or m", note="path of what slides per unit coordinate")
    coefficient: DeviceArray = reals("joint_friction")
    slip_velocity: DeviceArray = reals(
        "joint_friction", unit="m/s", note="of a law without stick, 0 of one that sticks"
    )
    radial: DeviceArray = reals("joint_friction", note="factor of the loads across the axis")
    axial: DeviceArray = reals("joint_friction", note="of the reaction along it")
    spin: DeviceArray = reals("joint_friction", unit="1/m", note="of the moment about it")
    bending: DeviceArray = reals("joint_friction", unit="1/m", note="load of a place per moment across the axis")
    preload: DeviceArray = reals("joint_friction", unit="N")
    held_start: DeviceArray = integers("joint_friction+1", note="into held")
    held: DeviceArray = integers("held_entry", note="rows of the joint, whose reactions press")


@topic
class Pretensions:
    """Joint coordinates that are pulled, and later locked, see `pretension`."""

    count: int
    row: DeviceArray = integers("pretension")
    signal: DeviceArray = integers("pretension", note="of the pull [N]")
    lock_at: DeviceArray = reals("pretension", unit="s", note="infinite: never")


@topic
class Characteristics:
    """Piecewise forces of springs and dampers over c or cdot, see `characteristics`."""

    start: DeviceArray = integers("characteristic+1", note="first piece")
    begin: DeviceArray = reals("piece_entry", unit="m, rad, m/s, rad/s", note="of each piece; of the first unused")
    origin: DeviceArray = reals("piece_entry", unit="m, rad, m/s, rad/s")
    coefficient: DeviceArray = reals("piece_entry", 8, note="ascending powers of x - origin")
    power: DeviceArray = reals("piece_entry", note="a of a sgn(x - origin) |x - origin|^p")
    exponent: DeviceArray = reals("piece_entry", note="p")
    constant: DeviceArray = reals("piece_entry", unit="J", note="of the potential")


@topic
class Signals:
    """Piecewise polynomials of degree 7."""

    start: DeviceArray = integers("signal+1", note="first piece")
    breaks: DeviceArray = reals("signal_entry", unit="s", note="where each piece begins")
    coefficient: DeviceArray = reals("signal_entry", 8, note="ascending powers of t - break")


@topic
class Forces:
    """Point forces."""

    count: int
    body: DeviceArray = integers("force")
    interface: DeviceArray = integers("force")
    point: DeviceArray = vectors("force", unit="m")
    in_body: DeviceArray = integers("force", note="1: components in body axes")
    signal: DeviceArray = integers("force", 3)


@topic
class Torques:
    """Point torques."""

    count: int
    body: DeviceArray = integers("torque")
    interface: DeviceArray = integers("torque")
    in_body: DeviceArray = integers("torque", note="1: components in body axes")
    signal: DeviceArray = integers("torque", 3)


@topic
class BodyLoads:
    """Loads that are constant in body axes except for a signal: surface and nodal loads."""

    count: int
    body: DeviceArray = integers("body_load")
    signal: DeviceArray = integers("body_load")
    force: DeviceArray = vectors("body_load", unit="N", note="per unit signal, body axes")
    torque: DeviceArray = vectors("body_load", unit="N m", note="about the centre of mass")
    modal: DeviceArray = reals("body_load", "body_load_mode", unit="N/kg^1/2", note="on the modes of the body")


@topic
class External:
    """External loads, read in place because few kernels use them."""

    forces: Forces
    torques: Torques
    body_loads: BodyLoads


@topic
class Surfaces:
    """Contact surfaces, body frame; see `surface`. Fields that end in `_start` are the offsets of tables."""

    body: DeviceArray = integers("surface", note="-1 for the ground, whose frame is the world")
    modal_start: DeviceArray = integers("surface", note="first mode of its body, 0 where it has none")
    modal_count: DeviceArray = integers("surface", note="modes of its body, 0 for a rigid one and the ground")
    origin: DeviceArray = vectors("surface", unit="m", note="axis point")
    frame: DeviceArray = matrices("surface", note="columns e_0, e_1, e_a")
    planar: DeviceArray = integers("surface", note="0: of revolution; theta in m: 1 a plane, 2 a curve, 3 a height")
    side: DeviceArray = reals("surface", note="1 material inside, -1 outside")
    radius: DeviceArray = reals("surface", unit="m", note="1 of a plane")
    tangent: DeviceArray = reals("surface", note="of a cone, slope dR/dz; of a curve, its twist [rad/m]; 0 without")
    crown: DeviceArray = reals("surface", unit="m", note="radius of the crown's arc, < 0 of a groove around a shaft")
    table_start: DeviceArray = integers("surface", note="into the two tables of the profile")
    table_count: DeviceArray = integers("surface", note="pieces of the profile table, 0 without")
    table_break: DeviceArray = reals("profile_entry", unit="m", note="count + 1 a table")
    table_coefficient: DeviceArray = reals("profile_entry", 4, note="powers of z - break; the last is unused")
    curve_start: DeviceArray = integers("surface", note="into the two tables of curves")
    curve_count: DeviceArray = integers("surface", note="pieces of the curve, 0 without")
    curve_length: DeviceArray = reals("surface", unit="m", note="period of a closed curve, 0 of an open one")
    curve_knot: DeviceArray = reals("curve_entry", unit="m", note="count + 1 a curve")
    curve_piece: DeviceArray = reals("curve_entry", 8, note="powers of u - knot of x, of y; of a height, two a piece")
    seed_start: DeviceArray = integers("surface", note="into curve_seed")
    seed_columns: DeviceArray = integers("surface", note="cells of the lattice along x")
    seed_rows: DeviceArray = integers("surface", note="along y, the faster index")
    seed_corner: DeviceArray = reals("surface", 2, unit="m", note="lower corner of the lattice")
    seed_pitch: DeviceArray = reals("surface", unit="m")
    curve_seed: DeviceArray = integers("seed_entry", note="piece nearest to the centre of a cell of the lattice")
    rigid: DeviceArray = integers("surface", note="1: no grid of its own, the tables hold two empty columns and rows")
    theta: DeviceArray = reals("surface", unit="rad", note="angle of column 0")
    pitch: DeviceArray = reals("surface", unit="rad", note="between columns")
    columns: DeviceArray = integers("surface")
    periodic: DeviceArray = integers("surface", note="1: nodes all around; 0: nodes on an arc only")
    turn: DeviceArray = integers("surface", note="columns of a full turn of the compliance, 0 where it covers an arc")
    rows: DeviceArray = integers("surface")
    z_start: DeviceArray = integers("surface", note="into z and cell_area")
    z: DeviceArray = reals("z_entry", unit="m", note="of the rows")
    mode_start: DeviceArray = integers("surface", note="into mode_normal and mode_moment")
    mode_normal: DeviceArray = reals("trace_entry", unit="kg^-1/2", note="(nodes, modes of the body) a surface")
    mode_moment: DeviceArray = reals("trace_entry", unit="m2 kg^-1/2", note="M Phi, same layout")
    cell_area: DeviceArray = reals("z_entry", unit="m2", note="a row of cells of friction")
    shear_start: DeviceArray = integers("surface", note="into mode_tangent, -1 without tangential compliance")
    mode_tangent: DeviceArray = reals(
        "shear_entry", unit="kg^-1/2", note="(columns, 2 rows, modes of the body) a surface"
    )


@topic
class Responses:
    """Displacement of the contact surfaces of a body due to loads on them by its local modes, see `responses`: the
    loads on each side (2 pair + side) of a pair, its own first, and tables (column of the block, source line, target
    column + reach, target line), 2 rows lines per tangential column."""

    load_start: DeviceArray = integers("side+1", note="into the loads on a side; a rigid surface has none")
    load_side: DeviceArray = integers("load_entry", note="whose load it is")
    normal: DeviceArray = integers("load_entry", note="table: normal displacement by normal loads, D")
    rubbed: DeviceArray = integers(
        "load_entry", note="table: normal displacement by tangential loads, D_nt; -1 without"
    )
    pressed: DeviceArray = integers(
        "load_entry", note="table: tangential displacement by normal loads, D_tn; -1 without"
    )
    tangential: DeviceArray = integers(
        "load_entry", note="table: tangential displacement by tangential loads; -1 without"
    )
    start: DeviceArray = integers("response", note="into number")
    source_block: DeviceArray = integers("response", note="columns of the source that turn with a block")
    target_block: DeviceArray = integers("response", note="columns of the target that do; 0 where it is an arc")
    source_turn: DeviceArray = integers("response", note="columns of the source's full turn, 0 of an arc")
    source_lines: DeviceArray = integers("response", note="lines of a column")
    target_lines: DeviceArray = integers("response", note="lines of a column")
    reach: DeviceArray = integers("response", note="columns of the target on each side of a block in the table")
    width: DeviceArray = integers("response", note="columns of the target in the table")
    number: DeviceArray = reals("response_entry", note="per load: weak displacement m3, displacement m; per Pa or N")


@topic
class Quadrature:
    """Stations of the line of centres between two rows of the first grid of each pair."""

    z_points: int
    z_abscissa: DeviceArray = reals("z_point", note="in (0, 1)")
    z_weight: DeviceArray = reals("z_point")


@topic
class Pairs:
    """Contact pairs."""

    count: int
    most_modes: int  # of a pair's two bodies
    coupled_capacity: int  # maximum of coupled_count
    beside: int  # 1: some pairs are coupled by modes, so that G has blocks between pairs
    dense: int  # 1: some have a matrix of their pressures
    matrix_free: int  # 1: some have none
    first: DeviceArray = integers("pair", note="surface")
    second: DeviceArray = integers("pair", note="surface")
    family: DeviceArray = integers("pair", note="0 LINE_OF_CENTRES, 1 AT_POINTS, 2 PATCH")
    matrix: DeviceArray = integers("pair", note="1: of nodes, or a small patch: pressures have a matrix")
    group: DeviceArray = integers("pair", note="the same for pairs that a chain of bodies and pairs connects")
    coupled_count: DeviceArray = integers("pair", note="retained columns the gap of a pair depends on")
    coupled: DeviceArray = integers("pair", "coupled", note="these")
    friction: DeviceArray = reals("pair", note="coefficient mu, the largest of all slip speeds; 0 without")
    slip_velocity: DeviceArray = reals(
        "pair", unit="m/s", note="of the regularised law of friction, 0 of a law that sticks"
    )


@topic
class SlipSpeeds:
    """Slip-speed-dependent friction coefficients, see `slip_speed`."""

    count: int  # pairs with one
    start: DeviceArray = integers("pair", note="first piece")
    pieces: DeviceArray = integers("pair", note="0 of a coefficient that is the same at all speeds")
    piece: DeviceArray = reals(
        "slip_speed_entry", 5, note="speed [m/s] it begins at, coefficients of a cubic from there"
    )


@topic
class Points:
    """Points of a column of the first grid, for the pairs of families 0 and 1, sorted by row."""

    most: int  # maximum number per pair, 0 without such pairs
    start: DeviceArray = integers("pair", note="first point")
    count: DeviceArray = integers("pair")
    row_start: DeviceArray = integers("pair", note="into row_at")
    row_at: DeviceArray = integers("row_of_points_entry", note="first point of each row of cells, from the pair's on")
    x: DeviceArray = reals("point_entry", note="fraction of the column, in [0, 1)")
    row: DeviceArray = integers("point_entry", note="row of cells")
    zeta: DeviceArray = reals("point_entry", note="fraction of the row, in [0, 1]")
    station: DeviceArray = integers(
        "point_entry", note="where it stands on the line of centres, see `line_of_centres_sampled`"
    )
    weight: DeviceArray = reals("point_entry", unit="m2")
    cosine: DeviceArray = reals("point_entry", note="of the angle from the column; of a plane 1")
    sine: DeviceArray = reals("point_entry", note="of a plane the distance, m")
    z: DeviceArray = reals("point_entry", unit="m")
    radius: DeviceArray = reals("point_entry", unit="m", note="R(z)")


@topic
class Window:
    """Extent of the windows of all pairs, and number of cells of one grid under one of the other."""

    half: int  # grid columns on each side of the line of centres
    columns: int  # 2 * half + 1
    rows: int  # of the first surface, maximum of all pairs
    grid_nodes: int  # columns * rows
    stencil_columns: int  # extent of a node of the first surface on the grid of the second
    stencil_rows: int
    second_half: int
    second_columns: int
    nodes: int  # second_columns * most rows of a second surface
    share_columns: int  # extent of a cell of the first grid on the cells of the second
    share_rows: int


@topic
class Capacity:
    """Capacity for simultaneously active nodes and cells, all pairs."""

    slots: int  # nodes: rows of G
    slot_limit: int  # maximum allowed by the capacities of the contacts
    cells: int  # cells that can carry friction


@topic
class Layers:
    """Layers whose compliance is not constant, see `layer_laws`, and the points of a column of the first grid at which
    they are evaluated, sorted by row."""

    count: int  # pairs with one
    kind: DeviceArray = integers("pair")
    number: DeviceArray = reals("pair", "layer_number")
    table_start: DeviceArray = integers("pair", note="into table")
    table_count: DeviceArray = integers("pair")
    table: DeviceArray = reals("layer_entry", 3, unit="m, Pa, J/m2", note="depth, pressure, energy")
    point_start: DeviceArray = integers("pair", note="into x and those that follow")
    point_count: DeviceArray = integers("pair")
    row_start: DeviceArray = integers("pair", note="into row_at")
    row_at: DeviceArray = integers("layer_row_entry", note="first point of each row of cells, from the pair's on")
    x: DeviceArray = reals("layer_point_entry", note="fraction of the column, in [0, 1)")
    row: DeviceArray = integers("layer_point_entry", note="row of cells")
    zeta: DeviceArray = reals("layer_point_entry", note="fraction of the row, in [0, 1]")
    area: DeviceArray = reals("layer_point_entry", unit="m2")


@topic
class Limits:
    """Tolerances and iteration limits of an attempt."""

    residual_tolerance: real  # of the contact force
    max_iterations: int
    max_inner: int
    max_guarded: int
    max_level: int
    energy_tolerance: real
    gain_limit: real  # allowed spurious energy, relative to the largest energy of a run; 0: unlimited


@topic
class Patches:
    """Pairs with contact-fixed cells, see the kernels of `patch`: family 2. Far fields have their own numbering;
    `far_of` gives the one of a surface."""

    count: int
    far_nodes: int  # splines of a far window, maximum, padded to a multiple of 8
    places: int  # cells of a pair, maximum: strips whose rows are padded to a multiple of 8
    far_columns_most: int  # columns of splines under a patch, maximum
    touching: int  # body sides with several of these patches, counted by pairs of them
    lasting: int  # 1: rows of G persist between steps, see `normal.compliance_reuse`
    strip_numbers: int  # that a product over strips needs, maximum
    spectrum_numbers: int  # of the blocks by frequency of a pair, maximum
    columns: DeviceArray = integers("pair", note="strips across")
    first: DeviceArray = integers("pair", note="surface with the mesh; pairs.first is the grid of cells on it")
    second: DeviceArray = integers("pair", note="likewise, or rigid")
    curvature: DeviceArray = reals("pair", unit="1/m", note="of one surface relative to the other, across")
    follows: DeviceArray = integers("pair", note="1: rows lie about the nearest place and grow with the patch")
    aspect: DeviceArray = reals("pair", note="length over width, where rows follow")
    middle: DeviceArray = reals("pair", unit="m", note="z where the nearest place is looked for, where they do not")
    least_width: DeviceArray = reals("pair", unit="m", note="of W")
    most_width: DeviceArray = reals("pair", unit="m")
    layer: DeviceArray = reals("pair", unit="m/Pa", note="of a straight layer between the surfaces")
    begins: DeviceArray = reals("pair", unit="m", note="gap from which on the layer presses, 0 or more")
    span: DeviceArray = reals("pair", note="half-widths b of the pressure that W is wide")
    row_start: DeviceArray = integers("pair", note="into the next two")
    row_z: DeviceArray = reals("patch_row_entry", unit="m", note="where rows follow, in W from the middle")
    row_length: DeviceArray = reals("patch_row_entry", unit="m", note="likewise")
    wave_start: DeviceArray = integers("pair", note="into wave: those of K, then those of the preconditioner")
    spectrum_start: DeviceArray = integers("pair", note="into spectrum: (level, frequency, loaded, displaced)")
    inverse_start: DeviceArray = integers("pair", note="into inverse: by level its diagonal, then blocks")
    near_levels: DeviceArray = integers("pair")
    near_first: DeviceArray = reals("pair", note="ln W of the first level")
    near_step: DeviceArray = reals("pair")
    near_power: DeviceArray = reals("pair", note="of W, which the near field is divided by")
    wave: DeviceArray = reals("wave_entry", note="(4, frequencies, pairs of strips)")
    spectrum: DeviceArray = reals("spectrum_entry", note="K of the half-spaces: weak displacement [m3] per Pa, W^power")
    inverse: DeviceArray = reals("inverse_entry", note="the preconditioner of pressures, times W^power")
    end_start: DeviceArray = integers("pair+1", note="into the next two, of pairs whose rows follow")
    end_z: DeviceArray = reals("patch_end_entry", unit="m", note="of A's meridian")
    end_strength: DeviceArray = reals("patch_end_entry", unit="m/N m", note="displacement per force over distance")
    far_of: DeviceArray = integers("surface", note="far field, -1 without")
    far_start: DeviceArray = integers("far_surface", note="into far: (lag in sectors, line, line)")
    far_sectors: DeviceArray = integers("far_surface")
    far_columns: DeviceArray = integers("far_surface", note="columns a sector")
    column_knots: DeviceArray = integers("far_surface", note="into knot, of a surface that does not close")
    row_knots: DeviceArray = integers("far_surface", note="into knot")
    mode_start: DeviceArray = integers("far_surface", note="into mode")
    far: DeviceArray = reals("far_entry", unit="m/N", note="S among splines")
    beside_start: DeviceArray = integers("side+1", note="into the next two: other patches on the body of a side")
    beside_side: DeviceArray = integers("beside_entry", note="whose loads")
    beside_table: DeviceArray = integers("beside_entry", note="what they displace")
    beside_between: DeviceArray = integers("beside_entry", note="table of the half-space between, -1: none")
    between_start: DeviceArray = integers("between_table", note="into between: (level of ln d, z, z)")
    between_levels: DeviceArray = integers("between_table")
    between_first: DeviceArray = reals("between_table", note="ln d of the first level")
    between_low: DeviceArray = reals("between_table", unit="m", note="first z")
    between_high: DeviceArray = reals("between_table", unit="m", note="last z")
    between: DeviceArray = reals("between_number", unit="m/N", note="half-space, cut off, with its ends")
    row_sign: DeviceArray = reals("side", note="of z on its surface, as rows stand on the first surface's meridian")
    row_offset: DeviceArray = reals("side", unit="m", note="likewise")
    table_start: DeviceArray = integers("beside_table", note="into beside: (lag in sectors, line, line of the source)")
    table_sectors: DeviceArray = integers("beside_table")
    table_target: DeviceArray = integers("beside_table", note="columns a sector of the target")
    table_source: DeviceArray = integers("beside_table", note="columns a sector of the source")
    beside: DeviceArray = reals("beside_number", unit="m/N", note="among splines; on one surface less the half-space")
    knot: DeviceArray = reals("knot_entry", note="of columns, or of z [m]")
    mode: DeviceArray = reals("far_mode_entry", unit="kg^-1/2", note="(columns, rows, modes of the body) a surface")


@topic
class Rolling:
    """Friction on contact-fixed cells, see the kernels of `rolling`: near fields along the surface, and the tangential
    part of far fields, numbered as in `Patches`."""

    count: int  # pairs with it
    shear_numbers: int  # of the near field of a pair at one W, maximum
    ring_cells: int  # cells including surrounding ones, maximum
    strips: int  # 1: tractions are solved for by products over strips, of all pairs with friction, see `rolling.strips`
    strip_numbers: int  # that a product needs, maximum
    spectrum_numbers: int  # of the blocks by frequency of a pair, maximum
    spectrum_start: DeviceArray = integers("pair", note="into spectrum: (level, frequency, loaded, displaced)")
    inverse_start: DeviceArray = integers("pair", note="into inverse: by level its diagonal, then blocks")
    spectrum: DeviceArray = reals("shear_spectrum_entry", note="K of the half-spaces, as shear")
    inverse: DeviceArray = reals("shear_inverse_entry", note="the preconditioner, times W^power")
    ring_rows: DeviceArray = integers("pair", note="rows around the cells, 0 where rows stay on the material")
    coupled: DeviceArray = integers("pair", note="1: pressures move the half-spaces along, tractions open the gap")
    shear_start: DeviceArray = integers(
        "pair", note="into shear: (level, kind, distance in strips, row under load, row that sees, filled up)"
    )
    shear: DeviceArray = reals(
        "near_shear_entry", note="weak displacement [m3] per traction or pressure [Pa] over W^power"
    )
    tangent_start: DeviceArray = integers("far_surface", note="into tangent, -1 without")
    sheared_start: DeviceArray = integers("far_surface", note="into sheared")
    turned_start: DeviceArray = integers("far_surface", note="into turned")
    tangent: DeviceArray = reals(
        "far_tangent_entry", unit="kg^-1/2", note="(2, columns, rows, modes of the body) a surface"
    )
    sheared: DeviceArray = reals(
        "sheared_entry", unit="m/N", note="(sector, direction, column, row, direction, column, row): S_tt"
    )
    turned: DeviceArray = reals("turned_entry", unit="m/N", note="(sector, column, row, direction, column, row): S_nt")


@topic
class Elements:
    """Topics that few scenes use. Every kernel takes a copy of the model, and the CUDA compiler takes minutes for one
    above 8 KiB: so these are read in place."""

    joint_frictions: JointFrictions
    pretensions: Pretensions
    characteristics: Characteristics
    slip_speeds: SlipSpeeds
    layers: Layers
    lumped: Lumped
    moments: Moments
    patches: Patches
    rolling: Rolling
    films: wp.array(dtype=Films)  # one, as these would exceed that size
    matched: wp.array(dtype=Matched)  # one


@topic
class Model:
    """All topics, gravity [m/s2], and the length of the scene [m], the reference of lengths of round-off size."""

    gravity: vec3
    length: real
    bodies: Bodies
    modes: Modes
    dense: Dense
    membrane: Membrane
    retained: Retained
    interfaces: Interfaces
    markers: Markers
    rows: Rows
    groups: Groups
    signals: Signals
    external: wp.array(dtype=External)  # one
    surfaces: Surfaces
    responses: Responses
    quadrature: Quadrature
    pairs: Pairs
    points: Points
    window: Window
    capacity: Capacity
    limits: Limits
    elements: wp.array(dtype=Elements)  # one
