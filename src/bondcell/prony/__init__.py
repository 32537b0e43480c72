"""Relaxation: Prony series of the matrix, and the exact ones of bonds that rest on it."""
