"""Jeffs et al. 2019 beside the model: published figures, the text's claims, the figures' counterparts."""
