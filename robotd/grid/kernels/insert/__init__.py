"""A sweep into the occupancy grid."""
