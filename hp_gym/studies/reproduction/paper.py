"""What Jeffs et al. 2019 published of their nine scenarios (doi 10.3384/ecp19157107, Tables 1 and 2)."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class PublishedScenario:
    """A row of Table 1 or 2.

    Attributes:
        id: Name of the scenario in `configs/scenarios`.
        label: Short name in the claims: S for case 1, D for case 2.
        description: What the row is about.
        energy_kwh: Energy consumed.
        final_soc_pct: Final state of charge; Table 2 gives none.
    """

    id: str
    label: str
    description: str
    energy_kwh: float
    final_soc_pct: float | None = None


PUBLISHED_SCENARIOS: Final = (
    PublishedScenario("jeffs2019/case1-1", "S1", "battery heated, PTC on", 8.08, 81.1),
    PublishedScenario("jeffs2019/case1-2", "S2", "battery cooled, PTC on", 8.24, 78.5),
    PublishedScenario("jeffs2019/case1-3", "S3", "battery isolated, PTC on", 7.68, 80.8),
    PublishedScenario("jeffs2019/case1-4", "S4", "battery isolated, PTC off", 6.45, 83.9),
    PublishedScenario("jeffs2019/case1-5", "S5", "battery cooled, PTC off", 7.68, 79.6),
    PublishedScenario("jeffs2019/case2-1", "D1", "ambient, PTC on", 7.82),
    PublishedScenario("jeffs2019/case2-2", "D2", "ambient and transmission, PTC on", 7.68),
    PublishedScenario("jeffs2019/case2-3", "D3", "ambient, PTC off", 6.05),
    PublishedScenario("jeffs2019/case2-4", "D4", "ambient and transmission, PTC off", 6.72),
)

LABELS: Final = {scenario.id: scenario.label for scenario in PUBLISHED_SCENARIOS}

LITERAL_VEHICLE: Final = "jeffs2019-40ah"
"""Vehicle with the 40 Ah cells of the paper's section 2.1, which Table 1 contradicts."""
