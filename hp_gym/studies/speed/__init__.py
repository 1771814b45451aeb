"""Speed of plant and environments, measured side by side with others."""
