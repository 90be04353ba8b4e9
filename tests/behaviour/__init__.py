"""Tests of the behaviours of users, without a run."""
