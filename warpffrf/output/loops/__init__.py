"""Loops of force against displacement: what a cycle takes, equivalent damping, stiffness against load."""
