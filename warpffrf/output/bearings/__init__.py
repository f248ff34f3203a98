"""Rolling bearings in a result: loads of the elements, contact angles, patches, motion of the rings, lives, stiffness.

bearing_result.py   BearingResult     patches.py   Hertz patches, truncation by shoulders, shear below
films.py   film thickness     stiffness.py   6 x 6     duty.py   life under a load spectrum
"""
