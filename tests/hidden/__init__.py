"""The sealed hidden-effect benchmark: make cases, run the public command, score its answers."""

import os

# many small matrices: more threads only get in each other's way (no use once NumPy is loaded)
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
