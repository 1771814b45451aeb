"""Every way in which a vehicle's architecture lets heat be moved, driven over ambient temperatures and ranked by energy at comfort."""
