"""What simulations are held against, and how they compare: closed forms, finite elements, exact half-spaces, scenes."""
