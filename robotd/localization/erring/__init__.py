"""How far readings must be trusted: the smallest error radius ([BrownDonald2000]_ sec. 2.2.1)."""
