"""Times of steps, runs kept for comparison, and another program."""
