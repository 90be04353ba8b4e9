"""Tests of behaviours: what users write, without a run."""
