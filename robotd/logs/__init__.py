"""Logs of other programs: lines in, scans and what was wrong with them out. No files: those are opened elsewhere."""
