"""Independent references: closed forms, half spaces, full finite elements, dense films, a monolithic solver, published
numbers.

They use neither engine nor reduction: of the package they import only the model (`warpffrf.model`), as stated in
pyproject.toml and checked by `make lint`. One file, `monolithic.results`, converts results of a reference to Results.
"""
