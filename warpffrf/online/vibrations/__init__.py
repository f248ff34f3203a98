"""Small motions about a state."""
