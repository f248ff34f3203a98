"""Rolling bearings in a result: loads of the elements, contact angles and patches, motion of the rings, lives,
stiffness.

bearing_result.py BearingResult patches.py Hertz's patches, and what shoulders cut off stiffness.py 6 x 6
"""
