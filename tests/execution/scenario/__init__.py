"""Tests of scenarios as they are read."""
