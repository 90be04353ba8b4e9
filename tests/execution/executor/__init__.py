"""Tests of how messages and commands are delivered."""
