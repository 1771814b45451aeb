"""Rules at their best: modes and set points of the HPCU chosen on training trips."""

from hp_gym import extras

extras.require("studies")
