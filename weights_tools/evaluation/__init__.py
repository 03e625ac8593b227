"""Errors of depth completion beside those of classical interpolation."""
