"""Maps on disk: versioned, checked, never half written."""
