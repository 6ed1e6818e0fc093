"""What people who wait are told: which stage of how many, bad tets, time gone by and about how much is left."""
