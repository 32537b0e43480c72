"""Stiffness of all models at a single cell."""

from __future__ import annotations

import numpy as np
import xarray as xr

from bondcell.figures.style import GREY, LINES, REFERENCES, Drawing, mathtext, new_figure
from bondcell.results.view import (
    is_reference,
    load_name,
    model_names,
    reference_names,
    stiffness_unit,
)
from bondcell.wording import STIFFNESS_SYMBOLS, model_name, percent, quantity, unit_text


def draw_bars(study: xr.Dataset, name: str = "stiffness") -> Drawing:
    """A bar for each model of a study without axes.

    Parameters
    ----------
    study
        A result with ``stiffness(model)``.
    name
        File name without suffix.
    """
    models = model_names(study)
    stiffness = study["stiffness"].sel(model=models)
    stiffness = stiffness.squeeze(drop=True).reset_coords(drop=True)
    values = np.atleast_1d(stiffness.values).astype(float)
    unit = stiffness_unit(study)
    load = load_name(study)
    figure = new_figure(6.4, 0.9 + 0.36 * len(models))
    axes = figure.subplots()
    places = np.arange(len(models))[::-1]
    colours = [(REFERENCES.get(m) or LINES.get(m) or {"color": GREY})["color"] for m in models]
    axes.barh(places, np.nan_to_num(values), height=0.62, color=colours)
    words = _words(study, models, values, unit)
    for place, value, word in zip(places, values, words, strict=True):
        axes.annotate(
            word,
            (0 if np.isnan(value) else value, place),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    axes.set_yticks(places, [model_name(model) for model in models])
    axes.set_xlim(0, 1.45 * np.nanmax(values, initial=0) or 1)
    axes.set_xlabel(
        f"{load} stiffness {mathtext(STIFFNESS_SYMBOLS.get(load, 'K_n'))} [{unit_text(unit)}]"
    )
    axes.grid(visible=False, axis="y")
    brackets = "; in brackets the error against finite elements" if reference_names(study) else ""
    caption = f"Stiffness of the bond by each model{brackets}."
    description = ". ".join(
        f"{model_name(model)}: {word}" for model, word in zip(models, words, strict=True)
    )
    return Drawing(figure, name, caption, description + ".")


def _words(study: xr.Dataset, models: list[str], values: np.ndarray, unit: str) -> list[str]:
    references = reference_names(study)
    true = values[models.index(references[0])] if references else np.nan
    words = []
    for model, value in zip(models, values, strict=True):
        word = quantity(value, unit) if np.isfinite(value) else "no value"
        if np.isfinite(value / true) and not is_reference(model):
            word += f" ({percent(value / true - 1, sign=True)})"
        words.append(word)
    return words
