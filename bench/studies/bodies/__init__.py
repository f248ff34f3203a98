"""Bodies in motion: free flight, inertia terms, large deflections, modal bases, flexible bearings."""
