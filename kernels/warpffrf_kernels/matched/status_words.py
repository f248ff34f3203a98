"""Status words of a group of small-sliding contacts, and requested state changes of cells."""

import warp as wp

# --- requested state changes of a cell
STAYS = wp.constant(0)
CLOSES = wp.constant(1)
OPENS = wp.constant(2)
RUBS = wp.constant(3)  # from stick to slip or back
TURNS = wp.constant(4)  # another direction of slip

# --- validity of a tableau
NONE = wp.constant(0)
STANDS = wp.constant(1)
ANEW = wp.constant(2)  # its table is valid; states and numbers of its cells must be set to those of the accepted forces

# --- status words of a group
READY = wp.constant(0)  # validity of its tableau
RANK = wp.constant(1)  # lines of cells that differ from the states of its table
SINCE = wp.constant(2)  # accepted steps since round-off was removed from its numbers
COUNT = wp.constant(3)  # columns to be added
NORMAL = wp.constant(4)  # cells to open or close
TANGENTIAL = wp.constant(5)
TURNING = wp.constant(6)
DONE = wp.constant(7)
KNOWN = wp.constant(8)  # differences for Anderson's method
HELD = wp.constant(9)  # 1 while its forces on the motion are frozen
AHEAD = wp.constant(10)  # 1 before the first evaluation of an attempt, which keeps the states of cells
DIFFERING = wp.constant(11)  # differing cells
FACTORED = wp.constant(12)  # 1 while the factors of M are those of the present states
ROOM = wp.constant(13)  # lines that may still differ before the table must be updated
