//! Least squares with banded matrices: long time series, linear cost.
