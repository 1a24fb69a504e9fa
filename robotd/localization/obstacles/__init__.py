"""What a map means to a beam: where the robot may stand, what stops a beam, what can end it."""
