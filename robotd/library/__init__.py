"""The engine without a daemon: maps and sweeps in a program or a notebook. ``import robotd`` offers its names."""
