"""Gear pairs of a run.

gear_result.py   GearResult: transmission error, loads of pairs of teeth, loss of contact
orders.py        orders of the mesh
flanks.py        map of the flanks, path of contact, film thickness
"""
