"""The model beside published values: rigs, chamber tests and cars, each row judged by a tolerance that was written down before."""
