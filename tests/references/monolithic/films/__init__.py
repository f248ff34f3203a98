"""Oil films in the monolithic system: what their pressure is made of, their equations, and a Newton correction."""
