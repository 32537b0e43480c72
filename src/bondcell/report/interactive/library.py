"""The library that draws in the browser: Vega-Lite with all it needs, once a page."""

from __future__ import annotations

import altair as alt
import vl_convert
from markupsafe import Markup


def drawing_library() -> Markup:
    """Source of Vega, Vega-Lite and Vega-Embed, safe inside a script element; no network is used.

    Notes
    -----
    The version is the one whose specifications altair writes.
    """
    version = alt.SCHEMA_VERSION.removeprefix("v").rsplit(".", 1)[0]
    source = vl_convert.javascript_bundle("window.vegaEmbed = vegaEmbed;", version)
    return Markup(source.replace("</script", "<\\/script"))
