"""Every way in which a vehicle can move heat, over ambient temperatures, ranked by energy at comfort."""
