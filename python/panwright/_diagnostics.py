"""Diagnostics of the library as exceptions and warnings of Python."""

from __future__ import annotations

import dataclasses
import json
import warnings


@dataclasses.dataclass(frozen=True)
class Diagnostic:
    """One problem: what is wrong, where, and what is accepted. `panwright explain CODE` says more."""

    code: str
    severity: str  # "error", "warning" or "note"
    message: str
    file: str = ""
    line: int = 0  # from 1; 0: the file as a whole
    column: int = 0
    object: str = ""  # path in the model
    hint: str = ""


class Error(Exception):
    """A call failed. `diagnostics` holds what was wrong, warnings too."""

    def __init__(self, text: str, diagnostics: list[Diagnostic], exit_code: int = 1):
        super().__init__(text)
        self.diagnostics = diagnostics
        self.exit_code = exit_code


class Cancelled(Error):
    """A call was cancelled."""


class PanwrightWarning(UserWarning):
    """Something that changes a result was guessed, dropped or replaced."""

    def __init__(self, diagnostic: Diagnostic):
        super().__init__(f"{diagnostic.message} [{diagnostic.code}]" + (f"; {diagnostic.hint}" if diagnostic.hint else ""))
        self.diagnostic = diagnostic


for kind in (Diagnostic, Error, Cancelled, PanwrightWarning):
    kind.__module__ = "panwright"


def settle(log: str, text: str, exit_code: int) -> None:
    """Warns of the warnings of a log, given as JSON, and raises an Error for its errors."""
    fields = {field.name for field in dataclasses.fields(Diagnostic)}
    content = json.loads(log)
    diagnostics = [Diagnostic(**{name: value for name, value in each.items() if name in fields}) for each in content["diagnostics"]]
    if content["errors"]:
        kind = Cancelled if exit_code == 130 else Error
        raise kind(text.strip(), diagnostics, exit_code)
    for each in diagnostics:
        if each.severity == "warning":
            warnings.warn(PanwrightWarning(each), stacklevel=3)
