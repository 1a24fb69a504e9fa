"""Answers on the terminal, as words, tables, bars and half blocks."""
