"""Controls of an interactive figure, as the page's own inputs and the script need them.

A control chooses among options. An option sets signals of the drawn figure, which is quick, or
replaces parts of its specification, after which it is drawn anew; it may switch off other controls.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

ENCODING = "/layer/1/encoding"
"""Where every specification has the encoding of its data; layer 0 is for what stands still."""


@dataclass(frozen=True)
class Option:
    """One choice.

    Parameters
    ----------
    label
        What the reader sees.
    signals
        Parameter of the specification -> value.
    patches
        JSON pointer into the specification -> new content; None removes what is there.
    disables
        Names of controls that mean nothing with this choice.
    """

    label: str
    signals: dict[str, Any] = field(default_factory=dict)
    patches: dict[str, Any] = field(default_factory=dict)
    disables: tuple[str, ...] = ()


@dataclass(frozen=True)
class Control:
    """A slider, a menu or a box to tick.

    Parameters
    ----------
    kind
        ``slider``, ``menu`` or ``box`` (its options are off and on).
    name
        Unique in the figure.
    label
        What the reader sees.
    options
        Choices in order.
    start
        Position of the first one.
    """

    kind: str
    name: str
    label: str
    options: tuple[Option, ...]
    start: int = 0

    def for_script(self) -> list[dict[str, Any]]:
        """The options as the page's script reads them."""
        return [
            {
                "label": option.label,
                "signals": option.signals,
                "patches": option.patches,
                "disables": option.disables,
            }
            for option in self.options
        ]


def logarithmic(axis: str, label: str, *, start: bool = True) -> Control:
    """A box that chooses the scale of an axis.

    Parameters
    ----------
    axis
        ``x`` or ``y``.
    label
        What the reader sees.
    start
        Whether it is ticked at first.
    """
    place = f"{ENCODING}/{axis}"
    linear = {f"{place}/scale/type": "linear", f"{place}/axis/values": None}
    options = (
        Option("linear", patches=linear),
        Option("log", patches={f"{place}/scale/type": "log"}),
    )
    return Control("box", f"log_{axis}", label, options, int(start))
