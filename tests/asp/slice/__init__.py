"""Tests of what of a program a question needs."""
