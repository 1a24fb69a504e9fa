"""The best poses, and all that come near them, without counting the rest."""
