"""Layers between the surfaces with nonlinear or damped laws."""
