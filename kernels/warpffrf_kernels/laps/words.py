"""Words of a group of laps, and what a cell may be asked to become."""

import warp as wp

# --- what a cell is asked to become
STAYS = wp.constant(0)
CLOSES = wp.constant(1)
OPENS = wp.constant(2)
RUBS = wp.constant(3)  # from stick to slip or back
TURNS = wp.constant(4)  # another direction of slip

# --- of what use a tableau is
NONE = wp.constant(0)
STANDS = wp.constant(1)
ANEW = wp.constant(2)  # its table is, states and numbers of its cells are to be those of the accepted forces

# --- words of a group
READY = wp.constant(0)  # whether its tableau is of use
RANK = wp.constant(1)  # lines of cells that differ from those of its table
SINCE = wp.constant(2)  # accepted steps since its numbers were put right
COUNT = wp.constant(3)  # columns to be added
NORMAL = wp.constant(4)  # cells to open or close
TANGENTIAL = wp.constant(5)
TURNING = wp.constant(6)
DONE = wp.constant(7)
KNOWN = wp.constant(8)  # differences for Anderson's rule
HELD = wp.constant(9)  # 1 while its forces on the motion stay as they are, whatever moves
AHEAD = wp.constant(10)  # 1 before the first evaluation of an attempt, which keeps the states of cells
DIFFERING = wp.constant(11)  # such cells
FACTORED = wp.constant(12)  # 1 while the factors of M are those of the states of now
ROOM = wp.constant(13)  # lines that may come to differ before the table must be made anew
