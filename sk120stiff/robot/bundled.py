"""Where the robots that come with the toolkit lie, in a checkout and in an installed wheel."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent


def bundled_robots() -> dict[str, Path]:
    """Folder of each bundled robot by its name, sorted by name.

    An installed wheel carries the robots as `sk120stiff/_robots`; a checkout has them at its top
    as `robots`. A robot is a folder that holds a `robot.yaml`.

    Examples:
        >>> import sk120stiff as sk
        >>> list(sk.bundled_robots())
        ['motoman_sk120', 'ur5e']
    """
    inside = _PACKAGE / "_robots"
    home = inside if inside.is_dir() else _PACKAGE.parent / "robots"
    return {path.parent.name: path.parent for path in sorted(home.glob("*/robot.yaml"))}
