"""Studies with the plant and its controllers: benchmark, tuning, calibration, reproduction, speed."""
