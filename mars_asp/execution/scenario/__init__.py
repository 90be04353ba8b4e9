"""Scenario files: the world, the devices and the requirements of a run."""
