"""Oil films alone, in NumPy and SciPy: what kernels of films are held against.

    grid             bilinear hats over a chart and their quadrature; donor-cell transport
    complementarity  pressure or void at every hat, by sets
    journal          a rigid shaft in a rigid bore: force at a place, motion under a load
    pads             sliders, plates that are squeezed, part and meet
    finite_volumes   the same steady film on finite volumes, written apart

None of these imports the engine, the kernels or the reduction.
"""
