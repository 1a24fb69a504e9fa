"""From a cell to a point: readings laid on walls."""
