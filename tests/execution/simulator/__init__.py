"""Tests of the world that a robot moves in."""
