"""A benchmark as a report that opens offline."""

from hp_gym.studies.benchmark.report.page import write_report

__all__ = ["write_report"]
