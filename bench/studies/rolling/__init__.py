"""Rolling and sliding contact with friction: Carter, Kalker, CONTACT, changes of creepage."""
