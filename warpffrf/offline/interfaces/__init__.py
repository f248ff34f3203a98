"""Interfaces of a body: what moves with them, and their unit loads."""
