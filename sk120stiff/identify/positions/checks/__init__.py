"""Positions, forces and payloads that cannot be as they are stated, told beside a calibration."""
