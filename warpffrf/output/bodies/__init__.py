"""Fields of a body: its deformed skin, what a patch puts on it, stress."""
