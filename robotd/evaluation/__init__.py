"""Cases in, results out: how often is the robot found on real logs, how often lost, and how often sure and wrong?"""
