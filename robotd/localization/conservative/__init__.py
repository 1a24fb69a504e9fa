"""Poses that cannot be excluded: the mode that never loses the true one."""
