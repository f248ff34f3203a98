"""Oil films alone, in NumPy and SciPy: references for the film kernels.

    grid             bilinear shape functions over a chart and their quadrature; donor-cell transport
    complementarity  pressure or cavity volume at every node, by sets
    journal          a rigid shaft in a rigid bore: force at a position, motion under a load
    pads             sliders, squeezed plates, plates with oscillating gap
    finite_volumes   the same steady film on finite volumes, implemented separately

None of these imports the engine, the kernels or the reduction.
"""
