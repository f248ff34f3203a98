"""Studies: scripts that compare the product with references, with itself and with other programs, and write docs/.

Each runs as `python -m studies.ROOM.NAME [FOLDER]`; its page says which one made it.
"""
