"""Dumps of the graphs of ROS robots: which node publishes and which subscribes to which topic."""

from mars_asp.exchange.rosgraph.read import import_rosgraph

__all__ = ["import_rosgraph"]
