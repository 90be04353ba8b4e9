"""Campaigns: many runs of one specification, over seeds and keys of the scenario."""
