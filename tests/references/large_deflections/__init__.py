"""Bodies that deflect far, by full geometrically nonlinear finite elements: what reduced bodies are held against.

None of these files imports the engine, the kernels or the reduction.
"""
