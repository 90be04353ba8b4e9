"""A specification run in a simulated world, and what comes of it."""
