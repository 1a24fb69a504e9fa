"""Readings counted: rnk, over all poses or at one."""
