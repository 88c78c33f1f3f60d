"""The command ``gonio``, as the program without Python: ``python -m gonio measure CAMPAIGN.toml``."""

import signal
import sys

from . import _gonio


def main() -> int:
    """Runs the command line of this process and returns the exit code."""
    # Python would raise KeyboardInterrupt when the program has answered Ctrl-C. One that is ignored stays so.
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _gonio.main(["gonio", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
