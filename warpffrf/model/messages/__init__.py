"""What the package says: messages, progress, interruptions, how objects show themselves."""
