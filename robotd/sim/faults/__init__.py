"""Everything that a serial cable can do, on purpose and repeatably."""
