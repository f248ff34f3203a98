"""Times of steps, runs kept for comparison, another program beside."""
