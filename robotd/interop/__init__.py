"""Other programs' formats: what they mean by a map, in and out."""
