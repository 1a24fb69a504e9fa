"""The console: JavaScript modules and styles, built into ``built/``, which the gateway serves."""
