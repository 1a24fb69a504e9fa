"""What a robot's constants are, found by driving and sweeping: arrays in, constants with their errors out."""
