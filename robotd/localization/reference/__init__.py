"""The paper's reference: slow and obvious twins of what the engine computes, called by tests and studies alone."""
