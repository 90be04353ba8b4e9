"""Modules read out of annotations in source code.

Nothing is imported here: a configuration without annotations needs none of it.
"""
