"""No text whatever crashes the interpreter, leaves a traceback or hangs.

300 mutants by default; ``SK120_MUTANTS=5000`` for the nightly run.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
MUTANTS = int(os.environ.get("SK120_MUTANTS", "300"))
PROCESSES = 2
SECONDS_EACH = 2.0  # generous: one takes about 20 ms


@pytest.mark.timeout(120 + SECONDS_EACH * MUTANTS)
def test_mutants_are_accepted_or_refused_and_nothing_else() -> None:
    share = -(-MUTANTS // PROCESSES)
    children = [
        subprocess.Popen(
            [sys.executable, "-m", "tests.robot.urdf.mutants", str(k * share), str(share)],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        for k in range(PROCESSES)
    ]
    counts = {"accepted": 0, "refused": 0}
    for child in children:
        try:
            said, at_work = child.communicate(timeout=60 + SECONDS_EACH * share)
        finally:
            child.kill()
        assert child.returncode == 0, f"died at {at_work[-2000:].decode(errors='replace')}"
        result = json.loads(said)
        assert not result["defects"]
        for key in counts:
            counts[key] += result["counts"].get(key, 0)
    assert sum(counts.values()) >= MUTANTS
    # Both roads are travelled; a test whose mutants are all refused proves nothing.
    assert min(counts.values()) > 0.2 * MUTANTS
