"""The answer: what was found, as frozen data, as a document, as files."""
