"""The program of a step: launches with arrays by name, participants that assign them to phases, and the graph."""
