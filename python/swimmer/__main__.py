"""The `swimmer` command, as the binary has it."""

import signal
import sys

from . import _swimmer


def main() -> int:
    # Python would only note Ctrl-C and go on; the command ends by it, or stops its robot first.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _swimmer.run(["swimmer", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
