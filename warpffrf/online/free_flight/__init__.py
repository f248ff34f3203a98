"""Bodies in free flight on the host, by integrators that verify the kernels."""
