"""Results: what files hold, and the tables and verdicts that follow from them."""
