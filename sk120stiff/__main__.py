"""`python -m sk120stiff` is the command `sk120stiff`."""

import sys

from sk120stiff.cli.main import main

sys.exit(main())
