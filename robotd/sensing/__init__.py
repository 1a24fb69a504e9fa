"""What to look at next, and where from, so that few readings and few stops tell where the robot is.

Pure, as all that is asked of the head: maps, places and readings in, bearings and legs out.
"""
