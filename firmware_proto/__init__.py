"""The contract with our own boards: what travels on the wire between the host and a microcontroller.

Standard library only. ``PROTOCOL.md`` is normative; the tables in it are generated from the declarations here.
"""
