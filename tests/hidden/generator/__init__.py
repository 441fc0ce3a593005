"""Measurements of elastic arms with known causes, made without any code of the product."""
