"""What the pressure and the tractions of a pair say: patch, Hertz, friction, forces, and how right the stress is."""
