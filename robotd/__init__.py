"""robotd: an onboard daemon that maps a building and says where the robot is, or that it does not know."""

__version__ = "0.2.0.dev0"
