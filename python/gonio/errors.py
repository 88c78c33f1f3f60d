"""What the program refuses, as exceptions: one class for each exit code, with the program's own line as its text."""

import json
from typing import Any


class GonioWarning(UserWarning):
    """What the program would say with ``warning:``."""


class GonioError(Exception):
    """The program's errors. ``exit_code`` is what the command would return."""

    exit_code: int = 70


class DisagreementError(GonioError):
    """A result breaks a law or an expectation."""

    exit_code = 1


class UsageError(GonioError, ValueError):
    """An argument is wrong."""

    exit_code = 2


class CampaignError(GonioError, ValueError):
    """A campaign cannot be understood. ``faults`` lists all its faults: path, line, column, key, value, allowed."""

    exit_code = 2

    def __init__(self, text: str, faults: list[dict[str, Any]] | None = None) -> None:
        super().__init__(text)
        self.faults: list[dict[str, Any]] = faults or []


class FileError(GonioError):
    """A file cannot be read or written, or its content is wrong."""

    exit_code = 3


class RefusedError(GonioError):
    """The job is refused: memory, time or size."""

    exit_code = 4


class InternalError(GonioError):
    """A broken invariant of the program itself."""

    exit_code = 70


_CLASSES = (DisagreementError, UsageError, FileError, RefusedError, InternalError)


def of(exit_code: int, text: str, faults: str | None) -> GonioError:
    """The exception of an error; ``faults`` is JSON."""
    if faults is not None and exit_code == CampaignError.exit_code:
        return CampaignError(text.replace("\nerror: ", "\n"), json.loads(faults))
    kind = next((kind for kind in _CLASSES if kind.exit_code == exit_code), InternalError)
    return kind(text.replace("\nerror: ", "\n"))
