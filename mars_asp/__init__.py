"""Reason about modular robots with the MARS model and answer set programming."""

__version__ = "0.1.0"
