"""Scene -> constants on the device."""
