"""The multiple-shooting core: a record in windows, their misfit, and its least squares in blocks.

`windows` cuts a record, `problem` says what is free, `multiple_shooting` gives the misfit and its normal equations, and
`levenberg` searches for its minimum by the steps of `block_levenberg`. What a fit makes of that stands in `jaxbacklash.fitting`.
"""
