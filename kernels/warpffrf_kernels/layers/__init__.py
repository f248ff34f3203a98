"""Layers between the surfaces whose yield is no constant."""
