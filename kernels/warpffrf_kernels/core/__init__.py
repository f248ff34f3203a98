"""What all kernels are made of: scalars, rotations, the model, control words, declarations, formulas of the step."""
