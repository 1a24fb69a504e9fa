"""Poses fitted to walls."""
