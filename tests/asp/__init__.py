"""Tests of the engine; no robot is used here."""
