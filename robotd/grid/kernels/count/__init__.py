"""From which cells readings are feasible, counted."""
