"""What is missing where readings say where markers stand: geometry, transmission, sag, the rest."""
