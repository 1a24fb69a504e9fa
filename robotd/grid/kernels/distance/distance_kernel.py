"""Squared distances, and what stands for none."""

import numpy as np

NOWHERE = int(np.iinfo(np.int32).max)
"""The squared distance to a source that is farther than anybody looked."""
