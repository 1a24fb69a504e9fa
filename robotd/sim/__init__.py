"""A robot that is not there: world, body, boards that speak the real protocol."""
