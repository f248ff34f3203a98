"""Full finite elements with unilateral contact and Coulomb friction between sheets, which laps are held against.

None of these files imports the engine, the kernels or the reduction.
"""
