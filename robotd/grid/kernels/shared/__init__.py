"""What several kernels stand on."""
