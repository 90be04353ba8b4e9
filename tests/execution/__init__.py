"""Tests of specifications that run in a world."""
