"""Dataflows of dora: which node takes which output of which other."""

from mars_asp.exchange.dora.read import import_dora

__all__ = ["import_dora"]
