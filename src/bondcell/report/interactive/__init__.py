"""Figures with controls: Vega-Lite specifications, compact data, sliders, menus and switches."""
