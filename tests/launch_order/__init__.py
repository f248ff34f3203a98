"""What launches read, set and change, from the source of their kernels, and the check of their order."""
