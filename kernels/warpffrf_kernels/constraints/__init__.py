"""Joints, springs and applied loads, and their geometric stiffness."""
