"""Modules and configurations as frozen values."""
