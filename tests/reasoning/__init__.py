"""Tests of reasoning about robots by rules."""
