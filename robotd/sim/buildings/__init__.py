"""Where a simulated robot drives: rooms in files, maps, recorded buildings."""
