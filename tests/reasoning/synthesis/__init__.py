"""Tests of specifications that are found."""
