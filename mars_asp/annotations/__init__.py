"""Modules that annotations in source code declare."""
