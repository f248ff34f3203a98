"""Bodies in free flight on the host, by integrators that check the kernels."""
