"""Turn the printed Table II of the 2005 paper into measurement files for the bundled SK120.

The printed files stay untouched in robots/motoman_sk120/data/printed/. The numbers are copied
digit for digit; only signs change, and the wrist is set straight. Why: see SOURCES.md.

    python scripts/make_sk120_data.py            rewrite robots/motoman_sk120/data/
    python scripts/make_sk120_data.py --out DIR  write there instead
"""

from __future__ import annotations

import argparse
import csv
import os
from pathlib import Path

DATA = Path(__file__).resolve().parents[1] / "robots" / "motoman_sk120" / "data"

ARM = ("joint_1_s[deg]", "joint_2_l[deg]", "joint_3_u[deg]")
WRIST = ("joint_4_r[deg]", "joint_5_b[deg]", "joint_6_t[deg]")
FORCE = ("fx[N]", "fy[N]", "fz[N]")
DISPLACEMENT = ("dx[mm]", "dy[mm]", "dz[mm]")

# The printed signs are not one coherent frame. With these columns negated, the calculated
# deflections follow from the geometry and the springs in base_link, to a fraction of a micrometre.
NEGATED = {
    "1": {"dx[mm]"},
    "2": {"dx[mm]"},
    "3": {"fy[N]", "fz[N]", "dy[mm]"},
}

COMMON_YAML = """\
robot: motoman_sk120
base_frame: base_link
tool_frame: tool0
# The flange with the wrist straight: with the printed wrist angles and the fixture,
# the paper's own calculated column does not come out (SOURCES.md).
point: {xyz: [0.0, 0.0, 0.0], unit: mm}
force: {frame: base}
"""

MEASURED_YAML = (
    COMMON_YAML
    + """\
# Each pose was read once without load; its five rows subtract that one reading.
displacement: {frame: base, zero: shared}
# No sigma: the scatter of a reading is not published, so it is estimated together with the fit.
# What the paper states of the laser tracker: distance resolution 1.26 um, coordinate repeatability
# +-5 ppm, accuracy +-10 ppm of a distance that it does not give; a reading averages 100 samples.
source: >
  G. Alici, B. Shirinzadeh, "Enhanced Stiffness Modeling, Identification and Characterization for
  Robot Manipulators", IEEE Transactions on Robotics, 2005, Table II, measured deflections.
  Signs converted to base_link by scripts/make_sk120_data.py from data/printed/table2.csv.
"""
)

CALCULATED_YAML = (
    COMMON_YAML
    + """\
displacement: {frame: base, zero: separate}
# Not measured but computed by the paper, printed to 0.1 um. Rounding alone scatters by
# 0.1/sqrt(12) = 0.0289 um per displacement; sigma is that of one of two readings, 0.0289/sqrt(2).
noise: {sigma: 0.0204, unit: um}
source: >
  G. Alici, B. Shirinzadeh, "Enhanced Stiffness Modeling, Identification and Characterization for
  Robot Manipulators", IEEE Transactions on Robotics, 2005, Table II, calculated deflections.
  Signs converted to base_link by scripts/make_sk120_data.py from data/printed/table2.csv.
"""
)


def negate(number: str) -> str:
    """Flip the sign of a printed decimal without touching its digits."""
    return number[1:] if number.startswith("-") else f"-{number}"


def convert(rows: list[dict[str, str]], calculated: bool) -> list[dict[str, str]]:
    """Printed rows of Table II -> rows of a measurement file, one displacement column kept."""
    converted = []
    for row in rows:
        flip = NEGATED[row["pose"]]
        out = {"pose": row["pose"]}
        out |= {name: row[name] for name in ARM}
        out |= dict.fromkeys(WRIST, "0")
        out |= {name: negate(row[name]) if name in flip else row[name] for name in FORCE}
        for name in DISPLACEMENT:
            printed = row[f"calc_{name}" if calculated else name]
            out[name] = negate(printed) if name in flip else printed
        converted.append(out)
    return converted


def write(path: Path, text: str) -> None:
    """Write to a temporary name, then rename: never a half file."""
    temporary = path.with_name(f".{path.name}.part")
    temporary.write_text(text, encoding="utf-8", newline="\n")
    os.replace(temporary, path)


def as_csv(rows: list[dict[str, str]]) -> str:
    lines = [",".join(rows[0])] + [",".join(row.values()) for row in rows]
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=DATA, help="folder to write to")
    out: Path = parser.parse_args().out
    with open(DATA / "printed" / "table2.csv", encoding="utf-8", newline="") as printed:
        rows = list(csv.DictReader(printed))
    out.mkdir(parents=True, exist_ok=True)
    write(out / "table2_measured.csv", as_csv(convert(rows, calculated=False)))
    write(out / "table2_measured.yaml", MEASURED_YAML)
    write(out / "table2_calculated.csv", as_csv(convert(rows, calculated=True)))
    write(out / "table2_calculated.yaml", CALCULATED_YAML)


if __name__ == "__main__":
    main()
