"""From poses to places: connected pieces, their shapes and circles."""
