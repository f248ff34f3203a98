"""Which places of two surfaces face each other: gaps, their weak form, and windows."""
