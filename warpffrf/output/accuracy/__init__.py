"""A run to a required accuracy: settings are chosen from the error budgets of coarse runs, see `choose`."""
