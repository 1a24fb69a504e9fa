"""Who may do what: tokens, sessions, roles, where a request comes from, how often. No web server in here."""
