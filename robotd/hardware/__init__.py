"""From bytes on a serial line to metres and radians, and back."""
