"""One browser: what it may say, whether somebody looks at it, and what it is sent."""
