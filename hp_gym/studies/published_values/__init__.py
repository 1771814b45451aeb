"""The model beside published values of rigs, chambers and cars, by tolerances written down before."""
