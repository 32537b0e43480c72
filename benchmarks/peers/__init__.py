"""The same cell solved by other codes."""
