"""Meshes that are generated: rollers, balls, blocks, boxes, sleeves."""
