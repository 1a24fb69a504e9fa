"""The smallest error radius of every cell."""
