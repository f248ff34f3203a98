"""Bodies and scenes shared by comparisons, studies, tests and benches."""
