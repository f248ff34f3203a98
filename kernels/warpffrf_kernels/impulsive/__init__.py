"""Contact that opens, closes or rebounds within a step."""
