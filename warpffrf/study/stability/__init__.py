"""A suite of hard cases over many steps: what is right, what is worse, what is refused, and what is wrong in silence.

    case.py      what a case is         classes.py   how a run of it is judged
    cases/       the cases              suite.py     all of them, a table and a heat map

`python -m warpffrf.study.stability.suite [FOLDER]` writes docs/stability.md.
"""
