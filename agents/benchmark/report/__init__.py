"""A benchmark as a report that opens offline."""

from agents.benchmark.report.page import write_report

__all__ = ["write_report"]
