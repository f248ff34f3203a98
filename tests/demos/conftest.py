"""Makes the modules next to it importable by the tests in the folders below."""
