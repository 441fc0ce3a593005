"""Readings of where markers stand become geometry, springs, and what cannot be told of them."""
