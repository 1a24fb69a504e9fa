"""The reference firmware of our own boards, compiled for this machine, on the plants of the simulation."""
