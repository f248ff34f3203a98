"""Small-sliding contact: cells with fixed partners, their unilateral contact and friction."""
