"""The program of a step: launches that bind arrays by name, participants that put them into phases, and the graph."""
