"""Many scenes in one graph, each as if it were alone."""
