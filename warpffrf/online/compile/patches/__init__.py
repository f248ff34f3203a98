"""Contact whose cells travel with the patch -> device tables."""
