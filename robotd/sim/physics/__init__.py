"""The simulated hardware without its boards: body, head, laser, walls, noise."""
