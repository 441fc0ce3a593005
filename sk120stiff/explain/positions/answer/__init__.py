"""Positions explained: the answer, its documents, and what to do next."""
