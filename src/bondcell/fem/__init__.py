"""The finite element reference of the bond cell (theory: "The finite element reference")."""
