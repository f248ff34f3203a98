"""Studies: scripts that compare the product with references, with itself and with other programs, and write docs/.

`python -m studies --list` lists them, `python -m studies NAME` makes a page; `page` is the harness.
"""
