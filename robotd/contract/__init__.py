"""What goes over the wire, declared once: requests, events, estimates, topics. Imports core alone."""
