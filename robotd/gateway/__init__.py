"""What people look at: a process that serves the robot's console, and is a client of the daemon like any other.

If it hangs, is attacked or dies, the robot loses one client. It sees the contract and the clients, and nothing of the
engine.
"""
