"""The commands, with one file for each. None works without the package's file of shipped parameters."""

import sys
from pathlib import Path

from sarah.errors import SarahError

try:
    import sarah.episode.tasks  # noqa: F401  # reads the file
except SarahError as error:
    print(f"{Path(sys.argv[0]).name}: error: {error}", file=sys.stderr)
    raise SystemExit(2) from None
