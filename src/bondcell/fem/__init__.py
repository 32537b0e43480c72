"""The finite element reference of the bond cell (theory: section "The finite element reference")."""
