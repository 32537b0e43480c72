"""``python -m bondcell``."""

import sys

from bondcell.cli import main

if __name__ == "__main__":
    sys.exit(main())
