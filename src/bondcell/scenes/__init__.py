"""Scenes: parameter files, read safely, checked whole and made immutable."""
