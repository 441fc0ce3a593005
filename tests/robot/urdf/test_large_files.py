"""Time and memory stay bounded, whatever is thrown at the reader; each case in a process."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
MEGABYTES = 1500
SECONDS = 60  # on a loaded machine; each takes a few seconds on a free one

CHILD = """
import json, resource, sys, threading, warnings
warnings.simplefilter("ignore")
from sk120stiff.errors import InputError
from sk120stiff.robot.checks import check_robot

def joint(k, parent, more=""):
    return (f'<link name="l{k}"><inertial><mass value="1"/></inertial></link><joint name="j{k}" '
            f'type="revolute"><parent link="l{parent}"/><child link="l{k}"/><axis xyz="0 0 1"/>'
            '<origin xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
            f'{more}</joint>')

def robot(*parts):
    return '<robot name="r"><link name="l0"/>' + "".join(parts) + "</robot>"

VISUAL = '<visual><geometry><box size="1 1 1"/></geometry></visual>'
CASES = {
    "star of 10000": lambda: robot(*(joint(k, 0) for k in range(1, 10_001))),
    "chain of 10000": lambda: robot(*(joint(k, k - 1) for k in range(1, 10_001))),
    "mimics of mimics": lambda: robot(joint(1, 0), *(
        joint(k, 0, f'<mimic joint="j{k - 1}"/>') for k in range(2, 5_001))),
    "arm in a swarm": lambda: robot(
        *(joint(k, k - 1) for k in range(1, 8)), *(joint(k, 0) for k in range(8, 2_000))),
    "chain of 250": lambda: robot(*(joint(k, k - 1) for k in range(1, 251))),
    "chain of 260": lambda: robot(*(joint(k, k - 1) for k in range(1, 261))),
    "elements": lambda: robot("<a/>" * 12_500_000),
    "kept elements": lambda: robot("<link name='x'>" + "<b/>" * 12_500_000 + "</link>"),
    "nesting": lambda: robot("<a>" * 8_000_000),
    "nesting in a link": lambda: robot("<link name='x'>" + "<a>" * 8_000_000),
    "50 MB of pictures": lambda: robot(
        "<link name='x'>" + VISUAL * 20_000 + " " * 49_000_000 + "</link>", joint(1, 0))
        .replace('<link name="l0"/>', '').replace("'x'", '"l0"'),
    "comments left open": lambda: robot("<!-- " * 10_000_000),
    "bad comments": lambda: robot("<!-- -- -->" * 200_000, joint(1, 0)),
    "ampersands": lambda: robot("&" * 50_000_000),
    "long name": lambda: robot(f"<link name='{'x' * 50_000_000}'/>"),
    "long number": lambda: robot(joint(1, 0).replace("1 0 0", "1" * 50_000_000)),
    "undeclared links": lambda: robot(*(
        f'<joint name="j{k}" type="fixed"><parent link="l0"/><child link="c{k}"/></joint>'
        for k in range(20_000))),
    "more than 100 MB": lambda: " " * 110_000_000 + robot(),
}

def main():
    try:
        report = check_robot(text)
        said.append(f"{len(report.actuated)} actuated")
    except InputError as error:
        said.append(str(error)[:400])

said = []
text = CASES[sys.argv[1]]()
threading.stack_size(1024 * 1024)  # a worker thread's stack, an eighth of the usual one
worker = threading.Thread(target=main)
worker.start()
worker.join()
print(json.dumps([*said, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000]))
"""

CASES = {
    "star of 10000": "1 actuated",
    "chain of 10000": "10000 joints lie one behind the other; at most 300",
    "mimics of mimics": "1 actuated",
    "arm in a swarm": "7 actuated",
    "chain of 250": "250 actuated",
    "chain of 260": "260 joints move between base and tool; at most 250",
    "elements": "more than",
    "kept elements": "more than",
    "nesting": "nested too deeply",
    "nesting in a link": "nested too deeply",
    "50 MB of pictures": "1 actuated",
    "comments left open": "not well-formed XML",
    "bad comments": "1 actuated",
    "ampersands": "not well-formed XML",
    "long name": "50000000 characters",
    "long number": "too long for a number",
    "undeclared links": "0 actuated",
    "more than 100 MB": "at most 105 MB",
}


@pytest.mark.timeout(2 * SECONDS)
@pytest.mark.parametrize("case", CASES)
def test_bounded(case: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", CHILD, case],
        cwd=ROOT,
        capture_output=True,
        timeout=SECONDS,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-1000:].decode(errors="replace")
    said, megabytes = json.loads(done.stdout)
    assert CASES[case] in said
    assert megabytes < MEGABYTES
