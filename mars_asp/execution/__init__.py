"""Runs of specifications in a simulated world, with verdicts and recordings."""
