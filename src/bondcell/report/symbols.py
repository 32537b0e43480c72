"""Plain text with symbols and powers of ten, set for the page."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

_SYMBOL = re.compile(
    r"(?<![\w/])([A-Za-zν])_(int|FE|[a-z]{1,2})(?![\w])|(?<=/)([A-Za-z])_([a-z])\b"
)


_POWER = re.compile(r"(?<![\w.])(\d(?:\.\d+)?)e(-?\d+)\b")

_TIED = re.compile(r" (?=[%=≥])|(?<=[=≥]) ")
"""Blanks at which a line does not break: before a per cent sign, around an equals sign."""


def with_subscripts(text: str) -> Markup:
    """Set the symbols in a text with italics and subscripts, its numbers with powers of ten.

    Examples
    --------
    >>> str(with_subscripts("E_i/E_m < 12"))
    '<i>E</i><sub>i</sub>/<i>E</i><sub>m</sub> &lt; 12'
    >>> str(with_subscripts("4.9e-7, 1e6"))
    '4.9·10<sup>−7</sup>, 10<sup>6</sup>'
    """

    def symbol(match: re.Match[str]) -> str:
        head, sub = match[1] or match[3], match[2] or match[4]
        return f"<i>{head}</i><sub>{sub}</sub>"

    def power(match: re.Match[str]) -> str:
        mantissa = "" if match[1] == "1" else f"{match[1]}·"
        return f"{mantissa}10<sup>{match[2].replace('-', '−')}</sup>"

    unbroken = _TIED.sub("\u00a0", text)
    return Markup(_POWER.sub(power, _SYMBOL.sub(symbol, str(escape(unbroken)))))
