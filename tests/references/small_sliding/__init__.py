"""Full finite elements with unilateral contact and Coulomb friction between sheets: references for small sliding.

None of these files imports the engine, the kernels or the reduction.
"""
