"""The addresses of the gateway, and what each answers."""
