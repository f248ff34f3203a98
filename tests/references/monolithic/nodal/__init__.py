"""Contact with the law at the FE nodes of the first surface, over the true shape of the second, with friction."""
