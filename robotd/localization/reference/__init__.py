"""What the engine is held against by tests, benchmarks and studies; no program of ours reaches it.

The paper's slow and obvious twins of what the engine computes.
"""
