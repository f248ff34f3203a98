"""What a run has saved, in user frames."""
