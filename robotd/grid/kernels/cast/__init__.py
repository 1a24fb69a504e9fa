"""Wall fields, and how far beams go in them."""
