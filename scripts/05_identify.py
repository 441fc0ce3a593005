"""From a CSV to an identified model with uncertainty.

Run from the repository:  python scripts/05_identify.py
"""

import tempfile
from pathlib import Path

from sk120stiff.identify import fit, fit_report, profile_intervals
from sk120stiff.measurements import read_measurements
from sk120stiff.model import joint_spring_model, write_model
from sk120stiff.robot import load_robot

robot = load_robot("motoman_sk120")
readings = read_measurements("robots/motoman_sk120/data/table2_measured.csv", robot.actuated)
start = joint_spring_model(robot, [1e5, 1e5, 1e5, *[float("inf")] * 3])  # N*m/rad, rigid wrist

found = fit(start, readings)
print(fit_report(found, profile=profile_intervals(found)))

for parameter, (low, high) in zip(found.parameters, found.intervals(), strict=True):
    print(f"{parameter.name}: {parameter.value:.4g} in {low:.4g} .. {high:.4g} N*m/rad")
print("Written to", write_model(found.model, Path(tempfile.gettempdir()) / "identified.yaml"))
