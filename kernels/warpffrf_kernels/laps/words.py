"""Words of a group of laps, and what a cell may be asked to become."""

import warp as wp

# --- what a cell is asked to become
STAYS = wp.constant(0)
CLOSES = wp.constant(1)
OPENS = wp.constant(2)
RUBS = wp.constant(3)  # from stick to slip or back
TURNS = wp.constant(4)  # another direction of slip

# --- words of a group
READY = wp.constant(0)  # 1 when its tableau stands
RANK = wp.constant(1)  # of what is kept beside the table
SINCE = wp.constant(2)  # accepted steps since its numbers were put right
COUNT = wp.constant(3)  # columns to be added
NORMAL = wp.constant(4)  # cells to open or close
TANGENTIAL = wp.constant(5)
TURNING = wp.constant(6)
DONE = wp.constant(7)
KNOWN = wp.constant(8)  # differences for Anderson's rule
HELD = wp.constant(9)  # 1 while its forces on the motion stay as they are, whatever moves
AHEAD = wp.constant(10)  # 1 before the first evaluation of an attempt, which keeps the states of cells
WORDS = 11
