"""Whole daemons that explore worlds in virtual time, held against somebody who knows the map."""
