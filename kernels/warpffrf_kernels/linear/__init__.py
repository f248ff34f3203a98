"""The outer system: dense with an inverse, or sparse with an order known beforehand."""
