"""Constants of lumped contacts, topics of the model."""

from warpffrf_kernels.core.declaration import DeviceArray, integers, reals, topic

NUMBERS = 14  # saved values per point: position, force and friction on the first body, slip velocity; approach, force


@topic
class Lumped:
    """Lumped contacts of two rigid surfaces, see `lumped`; their contact points, one point or the laminae of a roller,
    are stored contact by contact."""

    count: int
    places: int
    first: DeviceArray = integers("lumped", note="surface")
    second: DeviceArray = integers("lumped", note="surface")
    stiffness: DeviceArray = reals("lumped", unit="N/m^n", note="of a power of the approach")
    exponent: DeviceArray = reals("lumped", note="n")
    table_start: DeviceArray = integers("lumped", note="into table")
    table_count: DeviceArray = integers("lumped", note="points of a tabulated law, 0 of a power")
    table: DeviceArray = reals("lumped_entry", 3, unit="m, N, J", note="approach, force, energy")
    damping: DeviceArray = reals("lumped", unit="s/m", note="chi of the factor 1 + chi a_dot")
    friction: DeviceArray = reals("lumped", note="coefficient mu, 0 without")
    slip_velocity: DeviceArray = reals("lumped", unit="m/s", note="of the regularised law, 0 of one that sticks")
    slip_start: DeviceArray = integers("lumped", note="into slip_piece")
    slip_count: DeviceArray = integers("lumped", note="pieces of mu beyond slip_velocity, 0 of one that stays")
    slip_piece: DeviceArray = reals("lumped_slip_entry", 5, note="speed it begins at, a cubic from there")
    shear: DeviceArray = reals("lumped", note="tangential stiffness over the normal one")
    contact: DeviceArray = integers("lumped_place", note="lumped contact of a place")
    lamina: DeviceArray = integers("lumped_place", note="1: a lamina of the first surface, 0: where both are nearest")
    z: DeviceArray = reals("lumped_place", unit="m", note="of a lamina, on the first surface")
    drop: DeviceArray = reals("lumped_place", unit="m", note="of a lamina's profile, added to its gap")
    share: DeviceArray = reals("lumped_place", note="of the law's force")
    moment: DeviceArray = integers("lumped_place", note="its number among points with resistance to rolling, -1")
    form_start: DeviceArray = integers("surface", note="into form_piece")
    form_count: DeviceArray = integers("surface", note="pieces of the form deviation around it, 0 without, see `form`")
    form_begin: DeviceArray = reals("surface", unit="rad", note="angle at which the first piece begins")
    form_piece: DeviceArray = reals("lumped_form_entry", 4, note="cubics of the depth [m] by angles [rad]")


@topic
class Moments:
    """Points of lumped contacts with rolling and pivoting resistance, in this order, see `lumped.moments`: min(bound
    F^bound_power, slope F^slope_power w)."""

    count: int
    place: DeviceArray = integers("lumped_moment", note="of a lumped contact")
    bound: DeviceArray = reals("lumped_moment", 2, unit="N m/N^p", note="0 without")
    bound_power: DeviceArray = reals("lumped_moment", 2, note="p")
    slope: DeviceArray = reals("lumped_moment", 2, unit="N m s/N^q", note="0 without")
    slope_power: DeviceArray = reals("lumped_moment", 2, note="q")
