"""The arm under load in Meshcat, as its users know it; and a server of it on loopback."""

from sk120stiff.show.meshcat.drawing import InMeshcat, in_meshcat

__all__ = ["InMeshcat", "in_meshcat"]
