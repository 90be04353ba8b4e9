"""Tests of answers to questions about a configuration."""
