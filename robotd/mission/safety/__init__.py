"""What may move and for how long: leases, holds, the battery. It knows of no map and of no mission."""
