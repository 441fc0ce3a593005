"""Rows of a log in which the arm stood still become one reading each."""
