"""Constant data of a scene on the device, filled by `warpffrf.online.compile`; every field is explained here.

Indices of absent things are -1. Body frames have their origin in the centre of mass (Tisserand frame).
"""

import warp as wp

from warpffrf_kernels.scalars import mat33, real, vec3


@wp.struct
class Model:
    body_count: int
    modal_count: int
    row_count: int  # joint constraints, drives and springs
    row_offset: int  # 6 * body_count + dense_count
    outer_count: int  # row_offset + row_count
    pair_count: int
    slot_capacity: int  # rows of G
    slot_limit: int  # the most that the capacities of the contacts allow
    gravity: vec3
    length: real  # m, of the scene: what lengths of round-off size are fractions of
    # bodies
    mass: wp.array(dtype=real)  # (bodies,) kg
    inertia: wp.array(dtype=mat33)  # (bodies,) kg m2, about the centre of mass, body axes
    modal_start: wp.array(dtype=int)  # (bodies + 1,)
    stiffness: wp.array(dtype=real)  # (modes,) omega^2
    damping: wp.array(dtype=real)  # (modes,) 2 zeta omega
    dynamic_count: int  # modes of kind 1 and 2
    top_frequency: real  # rad/s, the highest of all modes
    outer_frequency: real  # rad/s, the highest of kind 0
    mode_kind: wp.array(dtype=int)  # (modes,) 0 the outer integrator's, 1 HHT, 2 exact for a linear load
    mode_reach: wp.array(dtype=real)  # (modes,) largest displacement per unit coordinate, m
    # modes that carry inertia, see `inertia`: the first ones of a body
    dense_count: int
    dense_body: wp.array(dtype=int)  # (dense,)
    dense_mode: wp.array(dtype=int)  # (dense,) which of all modes
    dense_of: wp.array(dtype=int)  # (modes,) the reverse, -1 for a diagonal one
    dense_start: wp.array(dtype=int)  # (bodies,) its first dense mode
    inertia_count: wp.array(dtype=int)  # (bodies,)
    inertia_start: wp.array(dtype=int)  # (bodies,) into inertia_table
    inertia_first: wp.array2d(dtype=real)  # (dense, 6) J1: xx yy zz xy yz zx
    inertia_table: wp.array(dtype=real)  # (9, count, count) a body: J2 as above, then G_ij with line j, column i
    # flexible interfaces
    interface_count: int
    interface_body: wp.array(dtype=int)
    interface_stiffening_start: wp.array(dtype=int)  # (interfaces,) into interface_stiffening, -1 without
    interface_stiffening: wp.array(dtype=real)  # (6, count, count) an interface: K per unit force, torque
    interface_point: wp.array(dtype=vec3)  # (interfaces,) m, body frame
    global_count: wp.array(dtype=int)  # (bodies,) modes that move interfaces, the first ones of the body
    interface_width: int  # largest global_count
    interface_modes: wp.array(dtype=real)  # (interfaces, 6, interface_width) flat: translation, rotation by the modes
    interface_reach: wp.array2d(dtype=real)  # (interfaces, 6) largest of interface_modes over the modes
    # markers: joint frames
    marker_body: wp.array(dtype=int)
    marker_interface: wp.array(dtype=int)
    marker_point: wp.array(dtype=vec3)  # m, body frame (world when on ground)
    marker_axes: wp.array(dtype=mat33)  # columns x, y, z of the marker in the body frame
    # rows: constraints and springs, c(x, t) = 0 or lambda = k c + d cdot + preload
    row_kind: wp.array(dtype=int)
    row_a: wp.array(dtype=int)  # marker
    row_b: wp.array(dtype=int)
    row_i: wp.array(dtype=int)  # axis of marker a
    row_j: wp.array(dtype=int)  # axis of marker b
    row_signal: wp.array(dtype=int)  # prescribed motion
    row_stiffness: wp.array(dtype=real)  # 0 for a rigid row
    row_damping: wp.array(dtype=real)
    row_reference: wp.array(dtype=real)  # subtracted from c
    row_preload: wp.array(dtype=real)
    row_rigid: wp.array(dtype=int)  # 1: constraint, 0: spring
    row_group: wp.array(dtype=int)  # group of a spring row that shares matrices with others
    row_vector: wp.array2d(dtype=real)  # (rows, 6): a bushing coordinate's part of displacement and rotation vector
    # groups of spring rows with lambda = K c + D cdot + preload, see `forces`
    group_count: int
    group_start: wp.array(dtype=int)  # first row; the others follow
    group_size: wp.array(dtype=int)
    group_sprung: wp.array(dtype=int)  # rows with stiffness, the first ones; the rest are dampers only
    group_stiffness: wp.array3d(dtype=real)  # (groups, MOST_COUPLED, MOST_COUPLED)
    group_damping: wp.array3d(dtype=real)
    # signals: piecewise polynomials of degree 7
    signal_start: wp.array(dtype=int)
    signal_break: wp.array(dtype=real)
    signal_coefficient: wp.array2d(dtype=real)  # (pieces, 8), ascending powers of t - break
    # point forces
    force_count: int
    force_body: wp.array(dtype=int)
    force_interface: wp.array(dtype=int)
    force_point: wp.array(dtype=vec3)
    force_in_body: wp.array(dtype=int)  # 1: components in body axes
    force_signal: wp.array2d(dtype=int)  # (forces, 3)
    # point torques
    torque_count: int
    torque_body: wp.array(dtype=int)
    torque_interface: wp.array(dtype=int)
    torque_in_body: wp.array(dtype=int)
    torque_signal: wp.array2d(dtype=int)  # (torques, 3)
    # loads that are constant in body axes but for a signal: surface and nodal loads
    load_count: int
    load_body: wp.array(dtype=int)
    load_signal: wp.array(dtype=int)
    load_force: wp.array(dtype=vec3)  # N per unit signal, body axes
    load_torque: wp.array(dtype=vec3)  # N m, about the centre of mass
    load_modal: wp.array2d(dtype=real)  # (loads, modes of the body)
    # contact surfaces, body frame; see `surface`
    surface_body: wp.array(dtype=int)  # -1 for the ground, whose frame is the world
    surface_modal_start: wp.array(dtype=int)  # first mode of its body, 0 where it has none
    surface_modal_count: wp.array(dtype=int)  # modes of its body, 0 for a rigid one and the ground
    surface_origin: wp.array(dtype=vec3)  # axis point
    surface_frame: wp.array(dtype=mat33)  # columns e_0, e_1, e_a
    surface_planar: wp.array(dtype=int)  # 1: a plane, theta in metres; 0: a surface of revolution
    surface_side: wp.array(dtype=real)  # 1 material inside, -1 outside
    surface_radius: wp.array(dtype=real)  # 1 of a plane
    surface_tangent: wp.array(dtype=real)  # of a cone's slope dR/dz, 0 without
    surface_crown: wp.array(dtype=real)  # radius of the crown's arc, negative for a groove around a shaft, 0 without
    surface_table_start: wp.array(dtype=int)  # into the two below
    surface_table_count: wp.array(dtype=int)  # pieces of the profile table, 0 without
    surface_table_break: wp.array(dtype=real)  # count + 1 a table, m
    surface_table_coefficient: wp.array2d(dtype=real)  # (count + 1 a table, 4) powers of z - break; the last is unused
    surface_rigid: wp.array(dtype=int)  # 1: no grid of its own, the tables hold two empty columns and rows
    surface_theta: wp.array(dtype=real)  # angle of column 0
    surface_pitch: wp.array(dtype=real)
    surface_columns: wp.array(dtype=int)
    surface_periodic: wp.array(dtype=int)  # 1: hats all around; 0: hats on an arc only
    surface_turn: wp.array(dtype=int)  # columns of the full turn that the compliance counts, 0 when it covers an arc
    surface_reach: wp.array(dtype=int)  # grid columns on each side of a block that its compliance tables hold
    surface_rows: wp.array(dtype=int)
    surface_block: wp.array(dtype=int)  # columns of a block of the compliance
    surface_z_start: wp.array(dtype=int)  # into surface_z
    surface_lag_start: wp.array(dtype=int)  # into compliance and self_compliance
    surface_mode_start: wp.array(dtype=int)  # into mode_normal and mode_moment
    surface_z: wp.array(dtype=real)
    compliance: wp.array(
        dtype=real
    )  # D as a table (column of the block, source row, target column + reach, target row), all surfaces
    self_compliance: wp.array(dtype=real)  # M D M, same layout
    mode_normal: wp.array(dtype=real)  # (nodes, modes of the body), flat per surface
    mode_moment: wp.array(dtype=real)  # M Phi, same layout
    # surfaces that serve several pairs, see `shared_surface`
    neighbour_start: wp.array(dtype=int)  # (surfaces + 1,) into the two below
    neighbour: wp.array(dtype=int)  # the same surface as another pair has it
    neighbour_table: wp.array(dtype=int)  # into shared_compliance: what a load there does here
    shared_compliance: wp.array(dtype=real)  # M D M, M D, D M and D in the layout of compliance
    # quadrature of a cell of the first grid of each pair
    theta_points: int
    theta_abscissa: wp.array(dtype=real)  # in (0, 1)
    theta_weight: wp.array(dtype=real)
    z_points: int
    z_abscissa: wp.array(dtype=real)
    z_weight: wp.array(dtype=real)
    # pairs
    pair_first: wp.array(dtype=int)  # surface
    pair_second: wp.array(dtype=int)
    pair_family: wp.array(dtype=int)  # 0: gap along the line of centres, 1: at points, see `contact_points`
    # points of a column of the first grid, of the pairs of family 1 and of those of few points, sorted by row
    most_points: int  # largest number of a pair, 0 without such pairs
    pair_point_start: wp.array(dtype=int)
    pair_point_count: wp.array(dtype=int)
    pair_row_start: wp.array(dtype=int)  # into point_row_at
    point_row_at: wp.array(dtype=int)  # first point of each row of cells, counted from the pair's, and their number
    point_x: wp.array(dtype=real)  # fraction of the column, in [0, 1)
    point_row: wp.array(dtype=int)  # row of cells
    point_zeta: wp.array(dtype=real)  # fraction of the row, in [0, 1]
    point_station: wp.array(dtype=int)  # where it stands on the line of centres, see `contact_few`
    point_weight: wp.array(dtype=real)  # m2
    point_cosine: wp.array(dtype=real)  # of the angle from the column; of a plane 1
    point_sine: wp.array(dtype=real)  # of a plane the distance, m
    point_z: wp.array(dtype=real)  # m
    point_radius: wp.array(dtype=real)  # R(z), m
    half_window: int  # grid columns on each side of the line of centres
    window_columns: int  # 2 * half_window + 1
    max_rows: int  # rows of the first surface, largest of all pairs
    mode_capacity: int  # window_columns * max_rows
    stencil_columns: int  # extent of a hat of the first surface on the grid of the second
    stencil_rows: int
    second_half_window: int
    second_columns: int
    node_capacity: int  # second_columns * most rows of a second surface
    pair_modes: int  # largest number of modes of a pair's two bodies
    coupled_count: wp.array(dtype=int)  # (pairs,) outer columns the gap of a pair depends on
    coupled: wp.array2d(dtype=int)  # (pairs, largest coupled_count)
    coupled_capacity: int
    # layers whose yield is no constant, see `layer_laws`
    layer_count: int  # pairs with one; 0: no kernel of `contact_layer` is recorded
    layer_kind: wp.array(dtype=int)  # (pairs,)
    layer_number: wp.array2d(dtype=real)  # (pairs, NUMBERS)
    layer_table_start: wp.array(dtype=int)  # (pairs,) into layer_table
    layer_table_count: wp.array(dtype=int)
    layer_table: wp.array2d(dtype=real)  # depth m, pressure Pa, energy J/m2
    # points of a column of the first grid at which the layer of a pair is evaluated, sorted by row
    layer_point_start: wp.array(dtype=int)  # (pairs,) into layer_x and those that follow
    layer_point_count: wp.array(dtype=int)  # (pairs,)
    layer_row_start: wp.array(dtype=int)  # (pairs,) into layer_row_at
    layer_row_at: wp.array(dtype=int)  # first point of each row of cells, counted from the pair's, and their number
    layer_x: wp.array(dtype=real)  # fraction of the column, in [0, 1)
    layer_row: wp.array(dtype=int)  # row of cells
    layer_zeta: wp.array(dtype=real)  # fraction of the row, in [0, 1]
    layer_area: wp.array(dtype=real)  # m2
    # friction in cells, see `friction_geometry`
    pair_friction: wp.array(dtype=real)  # (pairs,) mu, 0 without
    pair_slip_velocity: wp.array(dtype=real)  # (pairs,) m/s of the regularised law, 0 of a law that sticks
    cell_capacity: int  # cells that can carry friction at once, all pairs
    cell_area: wp.array(dtype=real)  # m2, a row of cells of each surface, at surface_z_start
    surface_shear: wp.array(dtype=int)  # into mode_tangent, -1 for a surface without tangential compliance
    mode_tangent: wp.array(dtype=real)  # (columns, 2 rows, modes of the body), flat per surface
    surface_tt: wp.array(dtype=int)  # into tangential: tangential displacement by tangential forces, D_tt
    surface_nt: wp.array(dtype=int)  # normal one by tangential forces: M D_nt of a first, D_nt of a second surface
    surface_tn: wp.array(dtype=int)  # its transpose
    tangential: wp.array(
        dtype=real
    )  # tables (column of the block, source line, target column + reach, target line); 2 rows lines a tangential column
    share_columns: int  # extent of a cell of the first grid on the cells of the second
    share_rows: int
    # tolerances
    residual_tolerance: real  # of the contact force
    max_iterations: int
    max_inner: int
    max_guarded: int
    max_level: int
    energy_tolerance: real
    most_made: real  # of the largest energy of a run: what may come from nowhere; 0: any
