"""Contact whose cells move with the patch -> device tables."""
