"""Makes the modules beside it importable by the tests in the folders below."""
