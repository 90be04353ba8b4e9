"""Tests of what the verbs share: the worker, and what a terminal shows."""
