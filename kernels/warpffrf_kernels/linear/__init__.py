"""The retained system: dense with an inverse, or sparse with a precomputed order."""
