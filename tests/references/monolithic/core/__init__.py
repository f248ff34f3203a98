"""The system without contact: bodies, rows, loads, their equations of motion, and the linear systems of a step."""
