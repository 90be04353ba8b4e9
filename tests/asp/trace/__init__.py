"""Tests of why atoms hold, and why not."""
