"""Fit of vehicle, controller and scenario parameters to published totals."""

from hp_gym import extras

extras.require("studies")
