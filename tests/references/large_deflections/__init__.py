"""Bodies with large deflections, by full geometrically nonlinear finite elements: references for reduced bodies.

None of these files imports the engine, the kernels or the reduction.
"""
