"""Fit of vehicle, controller and scenario parameters to published totals."""
