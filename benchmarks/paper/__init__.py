"""The source paper item by item: every table and figure that rests on data or simulation, `python -m benchmarks.paper`."""
