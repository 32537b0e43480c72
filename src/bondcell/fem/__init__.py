"""The finite element reference of the bond cell (theory: "The finite element reference")."""

import logging

# Elements of any order are asked for by one name: that others are quicker at order 2 is no news.
for _name in ("element_line.element_line_pp", "element_quad.element_quadp"):
    logging.getLogger(f"skfem.element.{_name}").setLevel(logging.ERROR)
