"""Error against what it costs: models as points, discretisations as ladders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import altair as alt
import numpy as np
import pandas as pd

from bondcell.report.interactive.controls import ENCODING, Control, Option, logarithmic
from bondcell.report.interactive.explorer import HEIGHT, switches
from bondcell.report.interactive.figure import (
    ONE,
    ROWS,
    SHOWN,
    Axis,
    Chart,
    InteractiveFigure,
    numbers,
    texts,
)
from bondcell.report.interactive.look import (
    MARKER,
    POWERS,
    colours,
    dashes,
    decades,
    shapes,
    unit_label,
)
from bondcell.wording import percent, quantity

COLUMNS = ("group", "name", "label", "error", "highest", "seconds", "dof", "order", "note")
"""Columns of the points: `group` is a choice of the menu, `highest` the end of a line upwards."""

LEAST_ERROR = 1e-12
"""Smaller errors are drawn at the lower edge."""


def cost_chart(
    points: pd.DataFrame,
    name: str,
    group_label: str,
    caption: str,
    *,
    against: Mapping[str, str],
    replaces: Sequence[str] = (),
) -> InteractiveFigure | None:
    """The figure, or None without points that have an error and a time.

    Parameters
    ----------
    points
        One row a point with the columns `COLUMNS`; times in seconds, errors relative.
    name
        Unique on the page.
    group_label
        What the menu chooses.
    caption
        What is drawn.
    against
        Column -> title at the axis, of what may lie along x.
    replaces
        Names of static figures that show the same.
    """
    points = points[(points["error"] > 0) & (points["seconds"] > 0)].reset_index(drop=True)
    if points.empty:
        return None
    names = list(dict.fromkeys(points["name"]))
    groups = list(dict.fromkeys(points["group"]))
    labels = points.drop_duplicates("name").set_index("name")["label"]
    ladders = points.groupby(["group", "name"]).size()
    joined = {str(n) for (_, n), size in ladders.items() if size > 1}
    controls = [
        Control(
            "menu",
            "group",
            group_label,
            tuple(Option(str(g), signals={"at_group": i}) for i, g in enumerate(groups)),
        ),
        _across(points, against),
        logarithmic("x", "log x"),
        logarithmic("y", "log y"),
    ]
    return InteractiveFigure(
        name=name,
        caption=caption,
        description=_description(points),
        chart=_chart(names, [n for n in names if n in joined], points),
        axes=[Axis("row", [""] * len(points))],
        columns=_columns(points, groups),
        controls=controls,
        switches=switches(names, [str(labels[n]) for n in names]),
        replaces=tuple(replaces),
    )


def _across(points: pd.DataFrame, against: Mapping[str, str]) -> Control:
    options = []
    for column, title in against.items():
        known = points[column][points[column] > 0]
        if known.empty:
            continue
        domain = (float(known.min()) / 1.5, 1.5 * float(known.max()))
        ticks = unit_label("s") if column == "seconds" else POWERS
        values = decades(*domain)
        axis: dict[str, Any] = {"title": title, "labelExpr": ticks}
        axis |= {"values": values} if values else {"tickCount": 7}
        scale = {"type": "log", "domain": list(domain), "nice": False}
        encoding = {"field": column, "type": "quantitative", "scale": scale, "axis": axis}
        options.append(Option(title, patches={f"{ENCODING}/x": encoding}))
    return Control("menu", "across", "Along x", tuple(options))


def _columns(points: pd.DataFrame, groups: Sequence[str]) -> dict[str, Any]:
    error = points["error"].clip(lower=LEAST_ERROR)
    return {
        "at": numbers([groups.index(group) for group in points["group"]], 6),
        "name": texts([str(n) for n in points["name"]]),
        "label": texts([str(n) for n in points["label"]]),
        "group": texts([str(n) for n in points["group"]]),
        "error": numbers(error, 3),
        "highest": numbers(points["highest"], 3),
        "seconds": numbers(points["seconds"], 3),
        "dof": numbers(points["dof"], 8),
        "order": numbers(points["order"], 2),
        "note": texts([str(n) for n in points["note"]]),
        "time": texts([quantity(t, "s", 2) for t in points["seconds"]]),
        "said": texts([percent(e) for e in points["error"]]),
        "most": texts([percent(e) if np.isfinite(e) else "" for e in points["highest"]]),
    }


def _chart(names: Sequence[str], joined: Sequence[str], points: pd.DataFrame) -> Chart:
    base = alt.Chart(alt.NamedData(ROWS)).transform_filter(
        f"indexof({SHOWN}, datum.name) >= 0 && datum.at == at_group"
    )
    colour = alt.Color(**colours(names))
    tooltip = [
        alt.Tooltip(field, title=title)
        for field, title in (
            ("label:N", "what"),
            ("said:N", "error"),
            *((("most:N", "at most"),) if points["highest"].notna().any() else ()),
            ("time:N", "time"),
            *((("dof:Q", "unknowns"),) if (points["dof"] > 0).any() else ()),
            *((("order:Q", "observed order"),) if points["order"].notna().any() else ()),
            *((("note:N", "which"),) if (points["note"] != "").any() else ()),
        )
    ]
    upward = base.transform_filter("isValid(datum.highest)").mark_rule(strokeWidth=1.5)
    line = base.transform_filter(f"indexof({list(joined)}, datum.name) >= 0")
    marks = base.mark_point(size=MARKER, strokeWidth=1.6, filled=True, opacity=1)
    low = float(points["error"].clip(lower=LEAST_ERROR).min())
    high = float(np.nanmax([points["error"].max(), points["highest"].max(), 1.0]))
    domain = (low / 2, 2 * high)
    scale = alt.Scale(type="log", domain=list(domain), clamp=True, nice=False)
    axis = alt.Axis(
        title="relative error", labelExpr=POWERS, values=decades(*domain) or alt.Undefined
    )
    y = alt.Y("error:Q", scale=scale, axis=axis)
    data = alt.layer(
        upward.encode(color=colour, y2="highest:Q"),
        line.mark_line(strokeWidth=2).encode(color=colour, strokeDash=dashes(names)),
        marks.encode(color=colour, shape=shapes(names), tooltip=tooltip),
    ).encode(x=alt.X("seconds:Q"), y=y)
    still = alt.Chart(alt.NamedData(ONE)).mark_rule(color="#666", strokeDash=[2, 3])
    chart = alt.layer(still.encode(y=alt.YDatum(0.01)), data)
    parameters = (alt.param(name=SHOWN, value=list(names)), alt.param(name="at_group", value=0))
    return chart.add_params(*parameters).properties(height=HEIGHT)


def _description(points: pd.DataFrame) -> str:
    """Of each group and name the smallest error and its time, in words."""
    said = []
    for (group, _), rows in points.groupby(["group", "name"], sort=False):
        best = rows.loc[rows["error"].idxmin()]
        cost = quantity(best["seconds"], "s", 2)
        said.append(f"{group}, {best['label']}: {percent(best['error'])} in {cost}")
    return f"{'; '.join(said)}."
