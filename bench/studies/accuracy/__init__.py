"""Errors that runs state, against the true ones.

`python -m studies.accuracy [FOLDER] [NAME ...]` makes docs/studies/accuracy.md, an hour, most of it for the bearing:
machines are run with `simulate(accuracy=)`, and what it chose is held against runs of the same machine with other
steps, contact grids, inertia levels and stiffening: whether the wanted error is kept, and how much faster the fastest
of those is that keep it too. Errors are those of the studies of speed against error
(`warpffrf.study.speed_against_error.errors`), beside a run with several times the steps, all inertia terms, and
finer cells where bodies have what those need. `budget_check` makes docs/studies/error_budget.md.
"""
