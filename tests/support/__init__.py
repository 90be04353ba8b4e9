"""Builders, oracles, campaigns and readers that tests share; no tests."""
