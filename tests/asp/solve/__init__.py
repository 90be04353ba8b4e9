"""Tests of how programs are grounded and solved."""
