"""Bodies and scenes that comparisons, studies, tests and benches share."""
