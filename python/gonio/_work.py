"""Waits for the program's work: shows how far it is, answers Ctrl-C, passes on what it says."""

import logging
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from ._gonio import Task
from .errors import GonioWarning

Progress = bool | Callable[[int, int], None]
_Show = Callable[[int, int], None]

# Seconds between two looks at Python's signals, and what work has to end by itself once it is asked to.
_TICK = 0.05
_GRACE = 0.5


def finished(task: Task, progress: Progress = False) -> str:
    """The task's result. Ctrl-C, or whatever else is raised meanwhile, asks the work to end."""
    try:
        with _shown(progress) as show:
            while not task.wait(_TICK):
                show(*task.progress())
            show(*task.progress())
    except BaseException:
        task.stop()
        task.wait(_GRACE)
        raise
    finally:
        _pass_on(task.said())
    return task.result()


def _pass_on(said: list[str]) -> None:
    for line in said:
        kind, _, text = line.partition(": ")
        if kind == "warning":
            warnings.warn(text, GonioWarning, stacklevel=_callers_level())
        else:
            logging.getLogger("gonio").info(line)


def _callers_level() -> int:
    """How many frames above this function's caller the package was entered."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back and frame.f_globals.get("__name__", "").startswith("gonio."):
        level, frame = level + 1, frame.f_back
    return level


@contextmanager
def _shown(progress: Progress) -> Iterator[_Show]:
    if callable(progress):
        yield progress
    elif not progress or not (sys.stderr.isatty() or _is_notebook()):
        yield lambda done, total: None
    else:
        bar = _tqdm()
        if bar is None:
            line = _Cell() if _is_notebook() else _Line()
            try:
                yield line.show
            finally:
                line.end()
        else:
            with bar:
                yield lambda done, total: _update(bar, done, total)


def _is_notebook() -> bool:
    python = sys.modules.get("IPython")
    return python is not None and hasattr(python.get_ipython(), "kernel")


def _tqdm() -> Any:
    """A bar of tqdm, where it is installed."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        return None
    return tqdm(unit=" samples", unit_scale=True, leave=False)


def _update(bar: Any, done: int, total: int) -> None:
    bar.total = total or None
    bar.update(done - bar.n)


class _Line:
    """A line of a terminal that is written over: per cent, and the samples of a second."""

    def __init__(self) -> None:
        self.begin = time.monotonic()
        self.next = 0.0

    def show(self, done: int, total: int) -> None:
        now = time.monotonic()
        if total == 0 or now < self.next:
            return
        self.next = now + 0.2
        rate = done / max(now - self.begin, 1e-3) / 1e6
        self.write(f"{100 * done / total:3.0f} % of {total / 1e6:.2f} M samples, {rate:.2f} M/s")

    def end(self) -> None:
        if self.next:
            self.write("")

    def write(self, text: str) -> None:
        # To the end of the line, whatever stood there.
        print(f"\r{text}\x1b[K", end="", file=sys.stderr, flush=True)


class _Cell(_Line):
    """The same below a cell of a notebook."""

    shown: Any = None

    def write(self, text: str) -> None:
        if self.shown is None:
            notebook: Any = import_module("IPython.display")
            self.shown = notebook.display({"text/plain": text}, raw=True, display_id=True)
        else:
            self.shown.update({"text/plain": text}, raw=True)
