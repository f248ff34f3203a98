"""The friction cone of one point: forces, or moments, that are at their bound along a vector.

With x a slip velocity, a trial force or a relative rotation, b the bound, and e = x/|x|,

    f = b e,      df = db e + (b/|x|) (1 - e e^T) dx.

Cells, whose bounds and slips are coupled, have theirs in `friction.friction_cone`; joints, whose friction is an
unknown, in `constraints.joint_friction`.
"""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def at_bound(x: vec3, bound: real) -> vec3:
    """b e."""
    return (bound / wp.length(x)) * x


@wp.func
def change_at_bound(x: vec3, bound: real, dx: vec3, dbound: real) -> vec3:
    """Change of b e with x and b."""
    size = wp.length(x)
    e = x / size
    return dbound * e + (bound / size) * (dx - wp.dot(e, dx) * e)
