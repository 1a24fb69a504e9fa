"""A recording that answers as the recorded boards did."""
