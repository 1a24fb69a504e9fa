"""TOML in, frozen dataclasses of any kind out, and every mistake named with its line; and back to text again."""
