"""The simulated robot: world, body, boards that speak the real protocol."""
