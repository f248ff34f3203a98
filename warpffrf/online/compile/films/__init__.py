"""Oil films of a scene -> device tables."""
