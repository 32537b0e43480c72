"""Jobs: what one step of a workflow computes, and how its files are put together."""
