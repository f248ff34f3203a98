"""The one place that fixes the precision of the kernels."""

import warp as wp

real = wp.float64
vec3 = wp.vec3d
mat33 = wp.mat33d
quat = wp.quatd

BLOCK = 64  # lanes of a block on a GPU; a CPU block has one lane unless wp.config.enable_cpu_blocks is set

MODULE_OPTIONS = {"enable_backward": False, "fast_math": False}


@wp.func_native("WP_TILE_SYNC();")
def sync(): ...
