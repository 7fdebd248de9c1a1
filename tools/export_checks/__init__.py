"""The checks of `check_export.py`, one subject a file."""
