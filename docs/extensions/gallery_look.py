"""One look for the pictures of the gallery: the package's own."""

from typing import Any

import matplotlib.pyplot as plt

from sk120stiff.show.figures.style import HOUSE


def reset(_gallery: dict[str, Any], _script: str) -> None:
    """Before each script: matplotlib as the package sets it for its own figures."""
    plt.rcdefaults()
    plt.rcParams.update(HOUSE)
