"""The 2005 paper recomputed: its tables, figures and claims beside ours."""

from sk120stiff.paper.reproduction import Reproduction, Verdict, reproduce

__all__ = ["Reproduction", "Verdict", "reproduce"]
