"""Which place is it, and is that sure? The second look."""
