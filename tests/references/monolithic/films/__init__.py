"""Oil films in the monolithic system: shape functions of their pressure, their equations, and a Newton correction."""
