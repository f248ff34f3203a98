"""Fields of a body: its deformed skin, surface fields of its contacts, stress."""
