"""The configuration: TOML in, a frozen typed tree out, and every mistake named with its line."""
