"""A run to a wanted accuracy: what a scene needs is chosen from the error budgets of coarse runs, see `choose`."""
