"""Tests of what rules decide about robots."""
