"""Joints that slide a little: cells of fixed partners, their unilateral contact and friction."""
