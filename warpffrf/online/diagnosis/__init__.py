"""What a run says about itself: why it failed, and what its results are worth."""
