"""Where the arm ends and what moves it, for every robot of a folder: tool frame, joints, fingers.

    python scripts/12_where_arms_end.py             the robots of the package example-robot-data
    python scripts/12_where_arms_end.py FOLDER      every .urdf below a folder

These are the defaults that a command takes when nobody gives --base and --tool. Other ends of the
robot are other arms, legs or heads, with the joints before them; fingers are held still. The public
ones come with `pip install "sk120stiff[corpus]"`.
"""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path

from sk120stiff import InputError
from sk120stiff.robot.urdf import FrameChoice, default_frames, read_urdf


def main() -> None:
    """One line per robot."""
    read = refused = 0
    for path in robots(sys.argv[1:]):
        name = f"{path.parent.parent.name}/{path.name}"
        try:
            choice = default_frames(read_urdf(path))
        except InputError as error:
            print(f"{name:<55} refused: {error.what}")
            refused += 1
            continue
        print(f"{name:<55} {row(choice)}")
        read += 1
    print(f"\n{read} read, {refused} refused.")


def robots(folders: list[str]) -> list[Path]:
    """URDF files below the folders, or those of example-robot-data."""
    if folders:
        return sorted(path for folder in folders for path in Path(folder).rglob("*.urdf"))
    files = metadata.distribution("example-robot-data").files or []
    return sorted(Path(str(file.locate())).resolve() for file in files if file.suffix == ".urdf")


def row(choice: FrameChoice) -> str:
    """Tool frame, number of its joints, other ends, fingers."""
    others = " ".join(f"{name}:{motors}" for name, motors in choice.others) or "-"
    return f"{choice.tool}:{choice.motors}  others {others}  fingers {len(choice.fingers)}"


if __name__ == "__main__":
    main()
