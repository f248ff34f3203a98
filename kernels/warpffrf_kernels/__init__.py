"""Warp kernels of warpffrf. Imports warp and the standard library, nothing else.

Every state array has the world as its first axis. Kernels of one world (or of one world and pair) are launched as
blocks whose lanes stride over the work items; on the CPU a block has one lane. Arguments: constants, inputs, then
outputs.
"""
