"""Every byte of the serial lines, to MCAP and back."""
