"""The best poses, found by bounds that hold."""
