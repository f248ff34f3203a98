"""Output of the package: messages, progress, interruptions, representations of objects."""
