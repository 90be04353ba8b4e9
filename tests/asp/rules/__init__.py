"""Tests of how rules are read and checked."""
