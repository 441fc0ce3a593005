"""Files: reading with clear complaints, writing so that nothing is lost.

Every reader of the package notes what it reads, and every writer looks there first
(`ledger`); nobody ever meets half a file, nor half a set of files (`writing`).
"""

from sk120stiff.files.cells import csv_text, guarded_cell, plain_cell
from sk120stiff.files.html_table import html_table
from sk120stiff.files.interrupts import remembered
from sk120stiff.files.ledger import note_read, running, will_fill, will_write
from sk120stiff.files.reading import read_bytes, read_text, sha256_of
from sk120stiff.files.schema import Finite, Strict, Vector, validated
from sk120stiff.files.writing import together, write_atomically
from sk120stiff.files.yaml_text import parse_yaml, read_yaml

__all__ = [
    "Finite",
    "Strict",
    "Vector",
    "csv_text",
    "guarded_cell",
    "html_table",
    "note_read",
    "parse_yaml",
    "plain_cell",
    "read_bytes",
    "read_text",
    "read_yaml",
    "remembered",
    "running",
    "sha256_of",
    "together",
    "validated",
    "will_fill",
    "will_write",
    "write_atomically",
]
