"""Models that are read: from files, and from text."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Optional, Union

from . import _native
from ._native import Expr

Value = Union[bool, int, float, str]


def formula(text: str) -> Expr:
    """A field from one formula of x, y and z, such as
    "sqrt(x^2 + y^2 + z^2) - 15"."""
    return _native.load("formula", text, "formula")


def script(
    text: str,
    params: Optional[Mapping[str, Value]] = None,
    name: str = "script",
) -> Expr:
    """A field from the text of a Rhai script.

    params: values of the script's parameters.
    name: the model's name, in messages and in the G-code.
    """
    return _native.load("script", text, name, _plain(params))


def vm(text: str, name: str = "vm") -> Expr:
    """A field from fidget's list of operations."""
    return _native.load("vm", text, name)


def load(
    path: Union[str, os.PathLike[str]],
    params: Optional[Mapping[str, Value]] = None,
) -> Expr:
    """A field from a script (.rhai) or a list of operations (.vm).

    params: values of the script's parameters, as -D on the command line.
    """
    return _native.load("file", path, "", _plain(params))


def _plain(given: Optional[Mapping[str, Value]]) -> Optional[dict[str, Value]]:
    return None if given is None else dict(given)
