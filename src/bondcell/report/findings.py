"""Sentences that results warrant; every number and every claim in them comes from the data."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """A sentence for a section; with a key figure it may also stand on the first screen.

    Parameters
    ----------
    text
        The sentence or sentences.
    key
        The figure that says it in short, empty for a finding of the section only.
    label
        What the figure is.
    topic
        What it is about: of each topic one finding stands on the first screen.
    brief
        The finding in one sentence for the first screen, where `text` is longer than that.
    """

    text: str
    key: str = ""
    label: str = ""
    topic: str = ""
    brief: str = ""
