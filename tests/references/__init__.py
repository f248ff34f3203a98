"""Independent references: closed forms, half spaces, full finite elements, dense films, a monolithic solver, published
numbers.

They know neither engine nor reduction: of the package they import the model alone (`warpffrf.model`), as pyproject.toml
says and `make lint` checks. One file, `monolithic.results`, makes Results of what a reference has found.
"""
